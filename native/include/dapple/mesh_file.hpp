// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/mesh_arrays.hpp>
#include <filesystem>
#include <span>

namespace dapple {

/// Read a mesh from .off, .obj, .ply or .stl. Polygons are cut into triangles, also those with
/// dents and those that are not quite flat.
/// \param may_be_empty whether a file without faces is read too, as a frame of a fluid may be one
/// \throw FileError naming the file and what is wrong with it
[[nodiscard]] MeshArrays read_mesh(const std::filesystem::path& path, bool may_be_empty = false);

/// All numbers of the vertices of a .ply file by name, also of one without faces.
/// \throw FileError naming the file and what is wrong with it
[[nodiscard]] std::vector<MeshAttribute> read_vertex_columns(const std::filesystem::path& path);

/// Write a triangle mesh in the format of the suffix: .off and .obj in text with every digit, .ply
/// in binary and double precision, .stl in binary and single precision. The file is written whole,
/// or what was there stays.
/// \throw FileError naming the file; SurfaceError naming the first vertex index out
/// of range
void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces);

}  // namespace dapple
