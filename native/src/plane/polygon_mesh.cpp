// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/polygon_mesh.hpp"

#include <CGAL/Polygon_2_algorithms.h>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "surface/constrained_triangulation.hpp"

namespace dapple {
namespace {

using Point = PlaneKernel::Point_2;
using Triangulation = ConstrainedTriangulation;

struct NamedRing {
  std::string name;
  std::vector<Point> points;
};

NamedRing check_ring(std::string name, const Ring& ring) {
  NamedRing result{std::move(name), {}};
  if (ring.size() < 3)
    throw ArgumentError(result.name + " has " + std::to_string(ring.size()) +
                        " points: a polygon needs at least 3");
  for (std::size_t k = 0; k < ring.size(); ++k) {
    for (Eigen::Index axis = 0; axis < 2; ++axis)
      if (!std::isfinite(ring[k][axis]))
        throw ArgumentError(entry(result.name.c_str(), k) + " is not finite: coordinate " +
                            std::to_string(axis) + " is " + number(ring[k][axis]));
    result.points.emplace_back(ring[k].x(), ring[k].y());
  }
  return result;
}

/// Triangulates disjoint rings.
class RingMesh {
 public:
  void insert_points(const NamedRing& ring) {
    std::vector<Triangulation::Vertex_handle>& vertices = rings_.emplace_back();
    for (std::size_t k = 0; k < ring.points.size(); ++k) {
      const auto vertex = mesh_.insert(ring.points[k]);
      if (mesh_.number_of_vertices() == vertices_.size())
        throw ArgumentError(entry(ring.name.c_str(), k) +
                            " repeats an earlier point: a polygon's points must differ");
      vertex->info() = static_cast<std::int32_t>(vertices_.size());
      vertices_.emplace_back(ring.points[k].x(), ring.points[k].y(), 0.0);
      vertices.push_back(vertex);
    }
  }

  void insert_edges(const NamedRing& ring, std::size_t index) {
    const auto& vertices = rings_[index];
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      const auto a = vertices[k], b = vertices[(k + 1) % vertices.size()];
      check_at(k, 64);
      if (!insert_edge(a, b))
        throw ArgumentError("the edge that starts at " + entry(ring.name.c_str(), k) +
                            " crosses or touches another edge: polygons must not meet themselves "
                            "or each other");
    }
  }

  /// The triangles that are inside an odd number of rings.
  Surface surface() {
    mark_inside(mesh_,
                [](Triangulation::Face_handle face, int k) { return face->is_constrained(k); });
    std::vector<Face> faces;
    for (const auto face : mesh_.finite_face_handles()) {
      if (!face->info().value_or(false)) continue;
      const auto corner = [&](int k) { return face->vertex(k)->info(); };
      faces.push_back({corner(0), corner(1), corner(2)});
    }
    return Surface(vertices_, faces);
  }

 private:
  bool insert_edge(Triangulation::Vertex_handle a, Triangulation::Vertex_handle b) {
    try {
      mesh_.insert_constraint(a, b);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return false;
    }
    return mesh_.is_edge(a, b);  // false if another point lies on the edge
  }

  Triangulation mesh_;
  std::vector<Vec3> vertices_;
  std::vector<std::vector<Triangulation::Vertex_handle>> rings_;
};

bool inside(const NamedRing& ring, const Point& point) {
  return CGAL::bounded_side_2(ring.points.begin(), ring.points.end(), point, PlaneKernel()) ==
         CGAL::ON_BOUNDED_SIDE;
}

/// \pre the rings do not meet
void check_nesting(const std::vector<NamedRing>& rings) {
  for (std::size_t k = 1; k < rings.size(); ++k) {
    if (!inside(rings[0], rings[k].points[0]))
      throw ArgumentError(rings[k].name + " is not inside the outline");
    for (std::size_t other = 1; other < rings.size(); ++other)
      if (other != k && inside(rings[other], rings[k].points[0]))
        throw ArgumentError(rings[k].name + " is inside " + rings[other].name +
                            ": holes must be disjoint");
  }
}

}  // namespace

Surface polygon_surface(const Ring& outline, std::span<const Ring> holes) {
  std::vector<NamedRing> rings = {check_ring("outline", outline)};
  for (std::size_t k = 0; k < holes.size(); ++k)
    rings.push_back(check_ring(entry("holes", k), holes[k]));
  RingMesh mesh;
  for (const NamedRing& ring : rings) mesh.insert_points(ring);
  for (std::size_t k = 0; k < rings.size(); ++k) mesh.insert_edges(rings[k], k);
  check_nesting(rings);
  return mesh.surface();
}

}  // namespace dapple
