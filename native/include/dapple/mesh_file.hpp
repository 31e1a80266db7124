// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <filesystem>
#include <span>
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

/// The triangles of a file and their attributes; arrays that the file does not provide are empty.
struct MeshArrays {
  std::vector<Vec3> vertices = {};
  std::vector<Face> faces = {};
  /// Per triangle, the polygon of the file that it was cut from, counted from 0.
  std::vector<std::int32_t> polygons = {};
  std::vector<FaceUv> uv = {};  ///< texture coordinates at the corners; 0 where there are none
  std::vector<std::array<Vec3, 3>> normals = {};  ///< at the corners; 0 where there are none
  std::vector<std::array<Color, 3>> colors = {};  ///< at the corners; white where there are none
  std::vector<MeshAttribute> attributes = {};     ///< other columns of a PLY file
};

/// Read a mesh from .off, .obj, .ply or .stl. Polygons are triangulated, also concave and slightly
/// bent ones.
/// \param may_be_empty whether to accept a file without faces, as a frame of a fluid may be
/// \throw FileError naming the file and the fault
[[nodiscard]] MeshArrays read_mesh(const std::filesystem::path& path, bool may_be_empty = false);

/// All numbers of the vertices of a .ply file by name, also of one without faces.
/// \throw FileError naming the file and the fault
[[nodiscard]] std::vector<MeshAttribute> read_vertex_columns(const std::filesystem::path& path);

/// Write a triangle mesh in the format of the suffix: .off and .obj in text with every digit, .ply
/// in binary and double precision, .stl in binary and single precision. The file is replaced only
/// after it was written completely.
/// \throw FileError naming the file; SurfaceError naming the first vertex index out
/// of range
void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces);

}  // namespace dapple
