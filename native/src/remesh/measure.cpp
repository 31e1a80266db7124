// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/measure.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/topology.hpp>
#include <numbers>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "lines/line_edges.hpp"
#include "skin/crossings.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kNothing = 1e-9;  // a barycentric coordinate: the place is on the edge opposite

void measure_angles(RemeshResult& mesh) {
  RemeshReport& report = mesh.report;
  double sum = 0.0;
  std::size_t below = 0;
  report.smallest_angle = mesh.faces.empty() ? 0.0 : 180.0;
  for (const auto& [a, b, c] : mesh.faces) {
    const double angle = smallest_angle(mesh.vertices[as_index(a)], mesh.vertices[as_index(b)],
                                        mesh.vertices[as_index(c)]);
    report.smallest_angle = std::min(report.smallest_angle, angle);
    sum += angle;
    if (angle < 30.0) ++below;
  }
  const double count = std::max<double>(static_cast<double>(mesh.faces.size()), 1.0);
  report.mean_smallest_angle = sum / count;
  report.below_30 = static_cast<double>(below) / count;
}

/// The edges of all triangles, the lower vertex first, and how many of them there are.
void measure_edges(RemeshResult& mesh) {
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const Face& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({a, b});
    }
  std::ranges::sort(edges);
  std::vector<std::int32_t> valence(mesh.vertices.size(), 0);
  std::int32_t distinct = 0;
  for (std::size_t k = 0, end = 0; k < edges.size(); k = end) {
    while (end < edges.size() && edges[end] == edges[k]) ++end;
    ++distinct;
    if (end - k > 2) ++mesh.report.nonmanifold_edges;
    for (const std::int32_t v : edges[k]) ++valence[as_index(v)];
  }
  std::size_t six = 0, inner = 0;
  for (std::size_t v = 0; v < valence.size(); ++v) {
    if (mesh.features[v] != VertexFeature::kFace) continue;
    ++inner;
    if (valence[v] == 6) ++six;
  }
  mesh.report.valence_6 = inner > 0 ? static_cast<double>(six) / static_cast<double>(inner) : 0.0;
  mesh.report.euler = static_cast<std::int32_t>(mesh.vertices.size()) - distinct +
                      static_cast<std::int32_t>(mesh.faces.size());
}

/// The faces that each vertex of a remesh touches: on an edge or a corner of the surface all around
/// it, since the one that it is stored with may be on the other side of a crease.
class TouchedFaces {
 public:
  /// \param vertices whether they are asked for, per welded vertex
  TouchedFaces(const OrderedSurface& mesh, std::size_t faces, const std::vector<bool>& vertices)
      : mesh_(mesh) {
    for (std::size_t f = 0; f < faces; ++f)
      for (const std::int32_t v : mesh.welded_corners(nth_face(f)))
        if (vertices[as_index(v)]) around_.push_back({v, static_cast<std::int32_t>(f)});
    std::ranges::sort(around_);
  }

  /// Whether all faces that are touched at a place fulfill a condition.
  template <typename Condition>
  [[nodiscard]] bool all_at(OrderedFace face, const Vec3& barycentric,
                            const Condition& condition) const {
    const auto zero = [&](int k) { return barycentric[k] < kNothing; };
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      if (zero(next) && zero(last))
        return all_around(mesh_.welded_corners(face)[as_index(k)], condition);
    }
    for (int k = 0; k < 3; ++k)
      if (zero((k + 2) % 3)) return all_beside(half_edge(face, k), condition);
    return condition(face);
  }

 private:
  template <typename Condition>
  [[nodiscard]] bool all_around(std::int32_t vertex, const Condition& condition) const {
    const auto first = std::ranges::lower_bound(around_, std::array<std::int32_t, 2>{vertex, -1});
    const auto last =
        std::ranges::lower_bound(around_, std::array<std::int32_t, 2>{vertex + 1, -1});
    return std::all_of(first, last, [&](const auto& entry) {
      return condition(nth_face(static_cast<std::size_t>(entry[1])));
    });
  }
  template <typename Condition>
  [[nodiscard]] bool all_beside(std::int32_t h, const Condition& condition) const {
    bool all = true;
    for_each_half_edge(mesh_, h, [&](std::int32_t g) { all = all && condition(face_of(g)); });
    return all;
  }

  const OrderedSurface& mesh_;
  std::vector<std::array<std::int32_t, 2>> around_;  // welded vertex, face
};

/// The number of triangles that pass through others.
std::size_t self_intersecting(const RemeshResult& mesh) {
  std::vector<OrderedFace> faces;  // as the lines are sorted by them
  for (const CrossingLine& line : find_crossings(Surface(mesh.vertices, mesh.faces)).lines)
    if (faces.empty() || faces.back() != line.face) faces.push_back(line.face);
  return faces.size();
}

}  // namespace

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 3> p = {a, b, c};
  double least = 180.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
    least = std::min(least, kDegrees * angle_of(u.cross(v).norm(), u.dot(v)));
  }
  return least;
}

std::vector<std::size_t> facing_away(const Surface& surface, const FeatureLines& lines,
                                     std::span<const Face> triangles, const Sites& vertices) {
  const OrderedSurface& old = surface.ordered();
  const auto own = [&](std::int32_t v) { return old.counted_face(vertices.faces[as_index(v)]); };
  const auto is_away = [&](const Face& t, const auto& all_at) {
    const Vec3& a = vertices.positions[as_index(t[0])];
    const Vec3 normal = (vertices.positions[as_index(t[1])] - a)
                            .cross(vertices.positions[as_index(t[2])] - a)
                            .normalized();
    return std::ranges::all_of(t, [&](std::int32_t v) {
      return all_at(v, [&](OrderedFace face) {
        return lines.sign(face) * normal.dot(old.geometry(face).normal) < 0.0;
      });
    });
  };
  std::vector<std::size_t> found;
  std::vector<bool> corners(old.vertex_count(), false);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    if (!is_away(triangles[k], [&](std::int32_t v, const auto& away) { return away(own(v)); }))
      continue;
    found.push_back(k);
    for (const std::int32_t v : triangles[k])
      for (const std::int32_t corner : old.welded_corners(own(v))) corners[as_index(corner)] = true;
  }
  if (found.empty()) return found;
  const TouchedFaces touched(old, surface.face_count(), corners);
  std::erase_if(found, [&](std::size_t k) {
    return !is_away(triangles[k], [&](std::int32_t v, const auto& away) {
      return touched.all_at(own(v), vertices.barycentric[as_index(v)], away);
    });
  });
  return found;
}

void measure_mesh(const Surface& surface, const FeatureLines& lines, RemeshResult& mesh) {
  RemeshReport& report = mesh.report;
  report.vertices = mesh.vertices.size();
  report.faces = mesh.faces.size();
  report.corners =
      static_cast<std::size_t>(std::ranges::count(mesh.features, VertexFeature::kCorner));
  report.on_lines = report.corners + static_cast<std::size_t>(
                                         std::ranges::count(mesh.features, VertexFeature::kLine));
  measure_angles(mesh);
  measure_edges(mesh);
  report.flipped =
      facing_away(surface, lines, mesh.faces, {mesh.vertices, mesh.source_faces, mesh.barycentric})
          .size();
  report.border_loops = -1;
  if (mesh.faces.empty()) return;
  report.self_intersecting = self_intersecting(mesh);
  SurfaceOptions plain;
  plain.weld = std::nullopt;
  report.border_loops = topology(Surface(mesh.vertices, mesh.faces, Density{}, plain)).border_loops;
}

}  // namespace dapple
