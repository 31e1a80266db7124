// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_builder.hpp"

#include <algorithm>
#include <bit>
#include <dapple/types.hpp>
#include <numeric>

#include "base/progress.hpp"
#include "base/random.hpp"
#include "surface/cut_polygon.hpp"
#include "surface/mesh_text.hpp"

namespace dapple {
namespace {

std::size_t as_size(std::int32_t k) { return static_cast<std::size_t>(k); }

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

/// A hash of a position. The sums of hashes of polygons differ even if coordinates differ only in
/// sign, as on opposite sides of a cube.
std::uint64_t mixed(const Vec3& place) {
  std::uint64_t result = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    result = Random(result + std::bit_cast<std::uint64_t>(place[axis] + 0.0)).bits();  // -0 is 0
  }
  return result;
}

/// For each corner of one polygon, the corner of another one at the same place; empty unless all
/// corners match.
std::vector<std::size_t> matched(std::span<const Vec3> there, std::span<const Vec3> here) {
  std::vector<std::size_t> result;
  if (there.size() != here.size()) return result;
  for (const Vec3& place : there) {
    const auto found = std::find(here.begin(), here.end(), place);
    if (found == here.end()) return {};
    result.push_back(static_cast<std::size_t>(found - here.begin()));
  }
  return result;
}

/// Twice the area times the normal.
Vec3 area_vector(std::span<const Vec3> places) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < places.size(); ++k)
    sum += (places[k - 1] - places[0]).cross(places[k] - places[0]);
  return sum;
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
  const std::vector<std::size_t> like = cut_like();
  for (std::size_t polygon = 0; polygon < ends_.size(); ++polygon) {
    check_at(polygon);
    cut(polygon, like[polygon], mesh);
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

std::vector<Vec3> MeshBuilder::places_of(std::size_t polygon) const {
  std::vector<Vec3> result;
  for (std::size_t k = first_corner(polygon); k < ends_[polygon]; ++k)
    result.push_back(vertices[static_cast<std::size_t>(corners_[k])]);
  return result;
}

/// For each polygon of more than three corners, the first polygon that may coincide with it corner
/// by corner, or itself. Both are cut in the same way, because doubled faces are recognized only if
/// their triangles agree.
std::vector<std::size_t> MeshBuilder::cut_like() const {
  std::vector<std::size_t> result(ends_.size());
  std::iota(result.begin(), result.end(), std::size_t{0});
  std::vector<std::pair<std::uint64_t, std::size_t>> sums;
  for (std::size_t polygon = 0; polygon < ends_.size(); ++polygon) {
    check_at(polygon);
    if (ends_[polygon] < first_corner(polygon) + 4) continue;
    std::uint64_t sum = 0;
    for (std::size_t k = first_corner(polygon); k < ends_[polygon]; ++k)
      sum += mixed(vertices[static_cast<std::size_t>(corners_[k])]);
    sums.emplace_back(sum, polygon);
  }
  std::sort(sums.begin(), sums.end());
  for (std::size_t k = 1; k < sums.size(); ++k)
    if (sums[k].first == sums[k - 1].first) result[sums[k].second] = result[sums[k - 1].second];
  return result;
}

void MeshBuilder::cut(std::size_t polygon, std::size_t like, MeshArrays& mesh) const {
  const std::size_t first = first_corner(polygon);
  if (ends_[polygon] < first + 3) return;
  if (ends_[polygon] == first + 3)
    return add_triangle(polygon, {first, first + 1, first + 2}, mesh);
  const auto add = [&](const std::array<std::size_t, 3>& corners) {
    add_triangle(polygon, {first + corners[0], first + corners[1], first + corners[2]}, mesh);
  };
  const std::vector<Vec3> here = places_of(polygon);
  if (like != polygon) {
    const std::vector<Vec3> there = places_of(like);
    const std::vector<std::size_t> match = matched(there, here);
    const bool turned = area_vector(there).dot(area_vector(here)) < 0.0;
    if (!match.empty()) {
      for (const auto& [a, b, c] : cut_polygon(there))
        add({match[as_size(turned ? c : a)], match[as_size(b)], match[as_size(turned ? a : c)]});
      return;
    }
  }
  for (const auto& [a, b, c] : cut_polygon(here)) add({as_size(a), as_size(b), as_size(c)});
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
