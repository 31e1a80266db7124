// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <vector>

namespace dapple {

/// Points of a surface, in spatial order, with the normals and components there.
struct LaidPoints {
  std::vector<Vec3> positions, normals;
  std::vector<std::int32_t> components;
};

/// When a point counts as opposite another one.
struct Opposition {
  double reach;   ///< it is nearer than that
  double depth;   ///< and less than that before or behind the plane of the other
  double cosine;  ///< the cosine between the normals is less than that
};

/// Whether at least `fewest` points have an opposite point on the same component.
[[nodiscard]] bool has_opposite_points(const LaidPoints& points, const Opposition& opposition,
                                       std::size_t fewest);

}  // namespace dapple
