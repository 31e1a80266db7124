// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <filesystem>
#include <span>

namespace dapple {

/// Triangles as they stand in a file.
struct MeshArrays {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

/// Read a triangle mesh through OpenMesh; polygons are cut into fans.
/// \throw FileError naming the file and what is wrong with it
[[nodiscard]] MeshArrays read_mesh(const std::filesystem::path& path);

/// Write a triangle mesh through OpenMesh (.ply in binary, double precision).
/// \throw FileError
void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces);

}  // namespace dapple
