// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <dapple/mesh_file.hpp>

#include "base/validate.hpp"
#include "base/whole_file.hpp"
#include "surface/mesh_readers.hpp"
#include "surface/mesh_writers.hpp"

// docs/development/reading.md compares other libraries with these readers.

namespace dapple {
namespace {

struct Format {
  const char* suffix;
  MeshArrays (*read)(std::string_view bytes);
  std::string (*write)(std::span<const Vec3> vertices, std::span<const Face> faces);
};

constexpr std::array<Format, 4> kFormats = {{{".off", read_off, to_off},
                                             {".obj", read_obj, to_obj},
                                             {".ply", read_ply, to_ply},
                                             {".stl", read_stl, to_stl}}};

const Format& format_of(const std::filesystem::path& path) {
  std::string suffix = path.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Format& format : kFormats)
    if (suffix == format.suffix) return format;
  throw FileError(path.string() + " has the suffix '" + suffix +
                  "': supported are .off, .obj, .ply and .stl");
}

/// Reads the bytes of a file; error messages begin with its name.
template <typename Read>
auto about(const std::filesystem::path& path, Read read) {
  if (!std::filesystem::is_regular_file(path))
    throw FileError(path.string() + " is not a readable file");
  const std::string bytes = read_whole(path);
  try {
    return read(std::string_view(bytes));
  } catch (const ReadError& error) {
    throw FileError(path.string() + ": " + error.what());
  }
}

}  // namespace

MeshArrays read_mesh(const std::filesystem::path& path, bool may_be_empty) {
  const Format& format = format_of(path);
  return about(path, [&](std::string_view bytes) {
    MeshArrays mesh = format.read(bytes);
    if (mesh.faces.empty() && !may_be_empty) throw ReadError("holds no faces");
    return mesh;
  });
}

std::vector<MeshAttribute> read_vertex_columns(const std::filesystem::path& path) {
  return about(path, read_ply_columns);
}

void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces) {
  const Format& format = format_of(path);
  check_faces(faces, vertices.size());
  write_whole(path, format.write(vertices, faces));
}

}  // namespace dapple
