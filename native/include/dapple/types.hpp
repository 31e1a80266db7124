// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace dapple {

/// A point or vector in space, in the units of the mesh.
using Vec3 = Eigen::Vector3d;

/// A point or vector in the plane.
using Vec2 = Eigen::Vector2d;

/// Three vertex indices of a triangle.
using Face = std::array<std::int32_t, 3>;

/// Points that lie on a surface: a position and the face that holds it.
struct Sites {
  std::vector<Vec3> positions = {};
  std::vector<std::int32_t> faces = {};  ///< indices into the caller's faces
  std::vector<Vec3> barycentric =
      {};  ///< of the positions in their faces; may be empty where nobody needs them

  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

}  // namespace dapple
