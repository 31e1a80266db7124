// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <dapple/mesh_file.hpp>

#include "base/validate.hpp"
#include "base/whole_file.hpp"
#include "surface/mesh_readers.hpp"
#include "surface/mesh_writers.hpp"

// The readers and writers are our own: those of CGAL and OpenMesh trust what they read (a word for
// a number, a property without an element and cut bytes have crashed them), round to single
// precision, or split vertices where faces do not fit into a half-edge mesh.

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
                  "': known are .off, .obj, .ply and .stl");
}

}  // namespace

MeshArrays read_mesh(const std::filesystem::path& path) {
  const Format& format = format_of(path);
  if (!std::filesystem::is_regular_file(path))
    throw FileError(path.string() + " is not a readable file");
  const std::string bytes = read_whole(path);
  try {
    MeshArrays mesh = format.read(bytes);
    if (mesh.faces.empty()) throw ReadError("holds no faces");
    return mesh;
  } catch (const ReadError& error) {
    throw FileError(path.string() + ": " + error.what());
  }
}

void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces) {
  const Format& format = format_of(path);
  check_faces(faces, vertices.size());
  write_whole(path, format.write(vertices, faces));
}

}  // namespace dapple
