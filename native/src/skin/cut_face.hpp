// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// A triangle cut into smaller ones.
struct CutFace {
  std::vector<Vec2> points;  ///< those given, then those where segments cross
  /// Counterclockwise like the triangle; of points that coincide only the first is used.
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Cut a triangle so that given segments become edges: a constrained Delaunay triangulation.
/// \param points   in the plane; the first three are the corners, counterclockwise, the others lie
///                 in the triangle
/// \param segments each by the indices of its ends; they may cross
[[nodiscard]] CutFace cut_face(std::span<const Vec2> points,
                               std::span<const std::array<std::int32_t, 2>> segments);

}  // namespace dapple
