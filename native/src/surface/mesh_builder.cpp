// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_builder.hpp"

#include <algorithm>
#include <dapple/limits.hpp>

#include "surface/cut_polygon.hpp"
#include "surface/mesh_text.hpp"

namespace dapple {
namespace {

std::string text(std::size_t k) { return std::to_string(k); }

void check_room(std::size_t vertices, std::size_t faces) {
  if (vertices > kMostVertices || faces > kMostSurfaceFaces)
    throw ReadError("holds " + text(vertices) + " vertices and " + text(faces) +
                    " triangles: at most " + text(kMostVertices) + " and " +
                    text(kMostSurfaceFaces) + " are possible");
}

template <typename T>
void add_corners(const Rows<T>& rows, std::size_t polygon, const Face& face,
                 const std::array<std::size_t, 3>& corners, const T& missing,
                 std::vector<std::array<T, 3>>& found) {
  if (rows.owner == Owner::kNothing) return;
  std::array<T, 3>& here = found.emplace_back();
  for (std::size_t k = 0; k < 3; ++k) {
    const T* value = rows.of(face[k], corners[k], polygon);
    here[k] = value ? *value : missing;
  }
}

}  // namespace

void MeshBuilder::add_polygon(std::span<const std::int64_t> corners) {
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  ends_.push_back(corners_.size());
}

void MeshBuilder::check() const {
  std::size_t first = 0, faces = 0;
  for (std::size_t polygon = 0; polygon < ends_.size(); ++polygon) {
    for (std::size_t k = first; k < ends_[polygon]; ++k)
      if (corners_[k] < 0 || static_cast<std::uint64_t>(corners_[k]) >= vertices.size())
        throw ReadError("face " + text(polygon) + " has vertex " + std::to_string(corners_[k]) +
                        ", outside 0.." +
                        std::to_string(static_cast<std::int64_t>(vertices.size()) - 1));
    const std::size_t size = ends_[polygon] - first;
    faces += size > 2 ? size - 2 : 0;
    first = ends_[polygon];
  }
  check_room(vertices.size(), faces);
}

void MeshBuilder::scale_colors() {
  float most = 0.0f;
  for (const Color& color : colors.values)
    for (const float value : color) most = std::max(most, value);
  const float scale = most > 1.0f ? 255.0f : 1.0f;
  for (Color& color : colors.values) {
    const bool opaque = color[3] == kNoOpacity;
    for (float& value : color) value = std::clamp(value / scale, 0.0f, 1.0f);
    if (opaque) color[3] = 1.0f;
  }
}

MeshArrays MeshBuilder::build() {
  check();
  scale_colors();
  MeshArrays mesh;
  mesh.faces.reserve(ends_.size());
  mesh.polygons.reserve(ends_.size());
  std::size_t first = 0;
  for (std::size_t polygon = 0; polygon < ends_.size(); ++polygon) {
    cut(polygon, first, ends_[polygon], mesh);
    first = ends_[polygon];
  }
  for (const MeshAttribute& attribute : attributes) {
    if (attribute.values.size() != (attribute.at_faces ? ends_.size() : vertices.size())) continue;
    MeshAttribute& found = mesh.attributes.emplace_back(attribute);
    if (!attribute.at_faces) continue;
    found.values.clear();
    for (const std::int32_t polygon : mesh.polygons)
      found.values.push_back(attribute.values[static_cast<std::size_t>(polygon)]);
  }
  mesh.vertices = std::move(vertices);
  return mesh;
}

void MeshBuilder::cut(std::size_t polygon, std::size_t first, std::size_t last,
                      MeshArrays& mesh) const {
  if (last < first + 3) return;
  if (last == first + 3) return add_triangle(polygon, {first, first + 1, first + 2}, mesh);
  std::vector<Vec3> places;
  for (std::size_t k = first; k < last; ++k)
    places.push_back(vertices[static_cast<std::size_t>(corners_[k])]);
  for (const auto& [a, b, c] : cut_polygon(places))
    add_triangle(polygon,
                 {first + static_cast<std::size_t>(a), first + static_cast<std::size_t>(b),
                  first + static_cast<std::size_t>(c)},
                 mesh);
}

void MeshBuilder::add_triangle(std::size_t polygon, const std::array<std::size_t, 3>& corners,
                               MeshArrays& mesh) const {
  Face face{};
  for (std::size_t k = 0; k < 3; ++k) face[k] = static_cast<std::int32_t>(corners_[corners[k]]);
  mesh.faces.push_back(face);
  mesh.polygons.push_back(static_cast<std::int32_t>(polygon));
  add_corners(uv, polygon, face, corners, Vec2(0.0, 0.0), mesh.uv);
  add_corners(normals, polygon, face, corners, Vec3(0.0, 0.0, 0.0), mesh.normals);
  add_corners(colors, polygon, face, corners, Color{1.0f, 1.0f, 1.0f, 1.0f}, mesh.colors);
}

}  // namespace dapple
