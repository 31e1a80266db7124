// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/unchanged.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>

#include "remesh/site_editor.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kSameDensity = 1e-3;  // relative difference

/// Vertices of a surface, then middles of its faces, whose densities are compared.
struct Probes {
  std::vector<Vec3> points;
  std::vector<double> densities;  // of the middles

  explicit Probes(const Surface& surface) : points(surface.vertices()) {
    const OrderedSurface& mesh = surface.ordered();
    for (std::size_t f = 0; f < surface.face_count(); ++f) {
      const OrderedFace face = mesh.ordered_face(static_cast<std::int32_t>(f));
      points.push_back(mesh.geometry(face).centroid);
      densities.push_back(mesh.densities(face).mean());
    }
  }
};

bool differ(double a, double b) { return std::abs(a - b) > kSameDensity * std::max(a, b); }

/// Per vertex, the longest edge: what is farther away does not touch its cell.
std::vector<double> reaches_of(const RemeshResult& mesh) {
  std::vector<double> result(mesh.vertices.size(), 0.0);
  for (const Face& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = as_index(t[k]), b = as_index(t[(k + 1) % 3]);
      const double length = (mesh.vertices[a] - mesh.vertices[b]).norm();
      result[a] = std::max(result[a], length);
      result[b] = std::max(result[b], length);
    }
  return result;
}

/// The vertices of a mesh and what is theirs.
struct VertexCells {
  const Neighbors& tree;
  std::vector<double> reaches;
};

/// Mark the vertices in whose cells there are places of a surface that another one does not have.
void mark_changes(const Surface& surface, const Surface& other, const Projector& projector,
                  const VertexCells& cells, double tolerance, std::vector<bool>& changed,
                  const Context* context) {
  const Probes probes(surface);
  const Projection found = projector.project(probes.points, {}, context);
  const std::size_t vertices = probes.points.size() - probes.densities.size();
  const OrderedSurface& there = other.ordered();
  const auto is_same = [&](std::size_t k) {
    if (found.distances[k] > tolerance) return false;
    if (k < vertices) return true;
    const OrderedFace face = there.counted_face(found.faces[k]);
    return !differ(probes.densities[k - vertices], found.barycentric[k].dot(there.densities(face)));
  };
  std::vector<Neighbor> nearest;
  for (std::size_t k = 0; k < probes.points.size(); ++k) {
    if (is_same(k)) continue;
    cells.tree.nearest(probes.points[k], 1, nearest);
    const auto v = as_index(nearest[0].index);
    if (std::sqrt(nearest[0].squared_distance) <= cells.reaches[v]) changed[v] = true;
  }
}

}  // namespace

Unchanged unchanged_vertices(const Surface& before, const RemeshResult& mesh, const Surface& next,
                             double tolerance, const Context* context) {
  const Projector to_next(next, false, context), to_before(before, false, context);
  Unchanged result{{}, to_next.project(mesh.vertices, {}, context)};
  const Neighbors tree(mesh.vertices);
  const VertexCells cells{tree, reaches_of(mesh)};
  std::vector<bool> changed(mesh.vertices.size());
  for (std::size_t k = 0; k < changed.size(); ++k)
    changed[k] = result.places.distances[k] > tolerance;
  mark_changes(next, before, to_before, cells, tolerance, changed, context);
  mark_changes(before, next, to_next, cells, tolerance, changed, context);
  changed = widened(mesh.faces, std::move(changed), 1);
  for (std::size_t k = 0; k < changed.size(); ++k) result.vertices.push_back(!changed[k]);
  return result;
}

}  // namespace dapple
