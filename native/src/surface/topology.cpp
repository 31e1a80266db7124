// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/topology.hpp>

#include "base/progress.hpp"
#include "surface/border_loops.hpp"
#include "surface/islands.hpp"
#include "surface/on_density.hpp"
#include "surface/openmesh.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// Count edges by the number of faces that meet at them; each edge is counted at its lowest
/// half-edge. Returns whether all faces are oriented consistently, that is, no two faces run along
/// their common edge in the same direction.
bool count_edges(const Surface& surface, Topology& result) {
  const auto start = [&](std::int32_t h) {
    return surface.ordered().welded_corners(face_of(h))[static_cast<std::size_t>(h % 3)];
  };
  bool consistent = true;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(3 * surface.face_count()); ++h) {
    check_at(static_cast<std::size_t>(h));
    if (!surface.ordered().counts(face_of(h))) continue;
    int faces = 1;
    bool lowest = true;
    for (std::int32_t g = surface.ordered().next_around(h); g != h;
         g = surface.ordered().next_around(g), ++faces) {
      lowest = lowest && h < g;
      consistent = consistent && start(g) != start(h);
    }
    if (lowest && faces == 1) ++result.border_edges;
    if (lowest && faces > 2) ++result.nonmanifold_edges;
  }
  return consistent;
}

/// Returns false if a face cannot be added because of a non-manifold edge or vertex or opposite
/// orientations.
bool build(const Surface& surface, HalfEdgeMesh& mesh) {
  std::vector<HalfEdgeMesh::VertexHandle> handles(surface.vertex_count());
  const auto handle = [&](std::int32_t v) {
    HalfEdgeMesh::VertexHandle& h = handles[static_cast<std::size_t>(v)];
    if (!h.is_valid())
      h = mesh.add_vertex({surface.ordered().vertex(v).x(), surface.ordered().vertex(v).y(),
                           surface.ordered().vertex(v).z()});
    return h;
  };
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    check_at(f);
    if (!surface.ordered().counts(nth_face(f))) continue;
    const auto [a, b, c] = surface.ordered().welded_corners(nth_face(f));
    if (a == b || b == c || c == a || !mesh.add_face(handle(a), handle(b), handle(c)).is_valid())
      return false;
  }
  for (const auto vertex : mesh.vertices()) {
    check_at(static_cast<std::size_t>(vertex.idx()));
    if (!mesh.is_manifold(vertex)) return false;
  }
  return true;
}

}  // namespace

Topology topology(const Surface& surface) {
  Topology result;
  result.components = surface.ordered().components();
  const bool consistent = count_edges(surface, result);
  result.border_loops = -1;
  HalfEdgeMesh mesh;
  result.manifold = consistent && result.nonmanifold_edges == 0 && build(surface, mesh);
  if (!result.manifold) return result;
  result.border_loops = count_border_loops(mesh);
  result.closed = result.border_loops == 0 && result.border_edges == 0;
  // Euler and Poincare: V - E + F = 2 components - 2 genus - borders.
  const auto euler = static_cast<std::int32_t>(mesh.n_vertices()) -
                     static_cast<std::int32_t>(mesh.n_edges()) +
                     static_cast<std::int32_t>(mesh.n_faces());
  result.genus = (2 * result.components - result.border_loops - euler) / 2;
  return result;
}

std::vector<std::int32_t> islands(const Surface& surface) {
  const OrderedSurface& mesh = surface.ordered();
  const std::shared_ptr<const Islands> known = islands_of(surface);
  std::vector<std::int32_t> numbers(known->count(), -1), result(surface.face_count(), -1);
  std::int32_t next = 0;
  for (std::size_t f = 0; f < result.size(); ++f) {
    check_at(f);
    const OrderedFace face = mesh.ordered_face(static_cast<std::int32_t>(f));
    if (!mesh.counts(face) || !has_density(surface, face)) continue;
    std::int32_t& number = numbers[known->at(face)];
    if (number < 0) number = next++;
    result[f] = number;
  }
  return result;
}

}  // namespace dapple
