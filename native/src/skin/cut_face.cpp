// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_face.hpp"

#include <algorithm>

#include "surface/constrained_triangulation.hpp"

namespace dapple {
namespace {

constexpr std::int32_t kNew = -1;

struct Index {
  std::int32_t value = kNew;
};

using CrossedTriangulation = CGAL::Constrained_Delaunay_triangulation_2<
    PlaneKernel,
    CGAL::Triangulation_data_structure_2<
        CGAL::Triangulation_vertex_base_with_info_2<Index, PlaneKernel>,
        CGAL::Constrained_triangulation_face_base_2<PlaneKernel>>,
    CGAL::Exact_predicates_tag>;

/// Number the points where segments cross in the order of their coordinates, because the order in
/// the triangulation is CGAL's own.
void number_new(CrossedTriangulation& mesh, std::vector<Vec2>& points) {
  std::vector<CrossedTriangulation::Vertex_handle> added;
  for (const auto vertex : mesh.finite_vertex_handles())
    if (vertex->info().value == kNew) added.push_back(vertex);
  std::sort(added.begin(), added.end(),
            [](const auto& a, const auto& b) { return a->point() < b->point(); });
  for (const auto& vertex : added) {
    vertex->info().value = static_cast<std::int32_t>(points.size());
    points.emplace_back(vertex->point().x(), vertex->point().y());
  }
}

}  // namespace

CutFace cut_face(std::span<const Vec2> points,
                 std::span<const std::array<std::int32_t, 2>> segments) {
  CutFace result{{points.begin(), points.end()}, {}};
  CrossedTriangulation mesh;
  std::vector<CrossedTriangulation::Vertex_handle> vertices;
  for (const Vec2& p : points) {
    const auto vertex = mesh.insert(PlaneKernel::Point_2(p.x(), p.y()));
    if (vertex->info().value == kNew)
      vertex->info().value = static_cast<std::int32_t>(vertices.size());
    vertices.push_back(vertex);
  }
  for (const auto& [a, b] : segments) {
    const auto from = vertices[static_cast<std::size_t>(a)];
    const auto to = vertices[static_cast<std::size_t>(b)];
    if (from != to) mesh.insert_constraint(from, to);
  }
  number_new(mesh, result.points);
  for (const auto face : mesh.finite_face_handles()) {
    std::array<std::int32_t, 3> corners{};
    for (int k = 0; k < 3; ++k)
      corners[static_cast<std::size_t>(k)] = face->vertex(k)->info().value;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.triangles.push_back(corners);
  }
  std::sort(result.triangles.begin(), result.triangles.end());
  return result;
}

}  // namespace dapple
