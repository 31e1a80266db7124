// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/image.hpp>
#include <dapple/types.hpp>
#include <string>

namespace dapple {

/// Red, green, blue and opacity, each 0 to 1.
using Color = std::array<float, 4>;

/// Named numbers of a file, one for each vertex or for each triangle.
struct MeshAttribute {
  std::string name;
  bool at_faces = false;
  std::vector<double> values;
};

/// Triangles as they stand in a file, and what the file says besides; what it does not say is
/// empty.
struct MeshArrays {
  std::vector<Vec3> vertices = {};
  std::vector<Face> faces = {};
  /// Of each triangle the polygon that it was cut from, counted from 0 in the order of the file.
  std::vector<std::int32_t> polygons = {};
  std::vector<FaceUv> uv = {};  ///< texture coordinates at the corners; 0 where there are none
  std::vector<std::array<Vec3, 3>> normals = {};  ///< at the corners; 0 where there are none
  std::vector<std::array<Color, 3>> colors = {};  ///< at the corners; white where there are none
  std::vector<MeshAttribute> attributes = {};     ///< the other numbers of a PLY file
};

}  // namespace dapple
