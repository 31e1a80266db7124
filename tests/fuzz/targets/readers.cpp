// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>

#include "expect.hpp"
#include "surface/mesh_readers.hpp"
#include "surface/mesh_writers.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

struct Format {
  MeshArrays (*read)(std::string_view bytes);
  std::string (*write)(std::span<const Vec3> vertices, std::span<const Face> faces);
  bool every_digit;
};

constexpr std::array<Format, 4> kFormats = {{{read_off, to_off, true},
                                             {read_obj, to_obj, true},
                                             {read_ply, to_ply, true},
                                             {read_stl, to_stl, false}}};

bool finite(const MeshArrays& mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [](const Vec3& p) { return p.allFinite(); });
}

void expect_faces(const MeshArrays& mesh) {
  for (const Face& face : mesh.faces)
    for (const std::int32_t v : face) {
      EXPECT_GE(v, 0);
      EXPECT_LT(static_cast<std::size_t>(v), mesh.vertices.size());
    }
}

/// Corners have their own of what any of them has.
void expect_corners(const MeshArrays& mesh) {
  const std::size_t faces = mesh.faces.size();
  EXPECT_EQ(mesh.polygons.size(), faces);
  EXPECT_TRUE(mesh.uv.empty() || mesh.uv.size() == faces);
  EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == faces);
  EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == faces);
  EXPECT_TRUE(std::is_sorted(mesh.polygons.begin(), mesh.polygons.end()));
  for (const auto& corners : mesh.colors)
    for (const Color& color : corners)
      for (const float part : color) EXPECT_TRUE(part >= 0.0f && part <= 1.0f);
  for (const MeshAttribute& attribute : mesh.attributes)
    EXPECT_EQ(attribute.values.size(), attribute.at_faces ? faces : mesh.vertices.size());
}

/// What was written is what is read. STL has its places in single precision, in another order.
void expect_round_trip(const Format& format, const MeshArrays& mesh) {
  const auto written = answer([&] { return format.write(mesh.vertices, mesh.faces); });
  if (!written) return;
  const MeshArrays again = format.read(*written);
  EXPECT_EQ(again.faces.size(), mesh.faces.size());
  if (!format.every_digit) return;
  EXPECT_EQ(again.faces, mesh.faces);
  EXPECT_EQ(again.vertices, mesh.vertices);
}

}  // namespace

void fuzz_readers(Bytes& bytes) {
  const Format& format = kFormats[bytes.byte() % kFormats.size()];
  MeshArrays mesh;
  try {
    mesh = format.read(bytes.rest());
  } catch (const ReadError&) {
    return;
  }
  expect_faces(mesh);
  expect_corners(mesh);
  if (finite(mesh)) expect_round_trip(format, mesh);
  if (mesh.faces.size() > 200) return;
  const auto surface = answer([&] { return Surface(mesh.vertices, mesh.faces); });
  if (surface) {
    EXPECT_GT(surface->area(), 0.0);
  }
}

}  // namespace dapple::fuzz
