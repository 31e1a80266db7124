// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/far_places.hpp"

#include <algorithm>
#include <dapple/neighbors.hpp>
#include <numeric>

#include "lines/line_edges.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// Vertices and middles of edges on lines; if `inside` those on none, and the middles of faces.
void add_places(const Surface& surface, const FeatureLines& lines, bool inside,
                std::vector<bool>& seen, std::vector<Place>& places) {
  const OrderedSurface& mesh = surface.ordered();
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const std::int32_t face = mesh.original_face(nth_face(f));
    Vec3 middle = Vec3::Zero();
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(nth_face(f), k), twin = twin_of(mesh, h);
      const std::int32_t on = lines.is_line(h) ? h : -1;
      const Vec3 &from = mesh.vertex(start_of(mesh, h)), &to = mesh.vertex(end_of(mesh, h));
      middle += from / 3.0;
      if ((on >= 0) == inside) continue;
      for (const std::int32_t v : {start_of(mesh, h), end_of(mesh, h)}) {
        if (!seen[as_index(v)]) places.push_back({mesh.vertex(v), face, on});
        seen[as_index(v)] = true;
      }
      if (twin < h) places.push_back({0.5 * (from + to), face, on});  // once for each edge
    }
    if (inside) places.push_back({middle, face, -1});
  }
}

std::vector<Place> places_of(const Surface& surface, const FeatureLines& lines) {
  std::vector<bool> seen(surface.vertex_count(), false);
  std::vector<Place> places;
  add_places(surface, lines, false, seen, places);
  add_places(surface, lines, true, seen, places);
  return places;
}

std::vector<Vec3> positions_of(std::span<const Place> places) {
  std::vector<Vec3> result;
  for (const Place& place : places) result.push_back(place.position);
  return result;
}

/// The middle of a triangle, or of an edge, whose second vertex stands twice.
struct Middle {
  Face of;
  Vec3 position;
};

/// Middles of triangles and of their edges that are on no line.
std::vector<Middle> middles_of(std::span<const Face> triangles,
                               std::span<const std::array<std::int32_t, 2>> lines,
                               std::span<const Vec3> positions) {
  std::vector<Middle> result;
  for (const Face& t : triangles) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      const Vec3 &p = positions[as_index(a)], &q = positions[as_index(b)];
      middle += positions[as_index(t[k])] / 3.0;
      if (a == t[k] && !std::ranges::binary_search(lines, std::array<std::int32_t, 2>{a, b}))
        result.push_back({{a, b, b}, 0.5 * (p + q)});
    }
    result.push_back({t, middle});
  }
  return result;
}

std::vector<Vec3> positions_of(std::span<const Middle> middles) {
  std::vector<Vec3> result;
  for (const Middle& middle : middles) result.push_back(middle.position);
  return result;
}

/// A mesh as a surface of its own.
Surface surface_of(std::span<const Vec3> vertices, std::span<const Face> triangles) {
  SurfaceOptions plain;
  plain.weld = std::nullopt;
  return {vertices, triangles, Density{}, plain};
}

/// Name the site nearest to each place, and sort.
void finish(const Sites& sites, std::span<const double> distances, FarPlaces& far) {
  const Neighbors tree(sites.positions);
  std::vector<Neighbor> nearest;
  for (Violation& one : far.places) {
    tree.nearest(one.place.position, 1, nearest);
    one.site = nearest[0].index;
  }
  std::vector<std::size_t> order(far.places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) { return distances[k]; });
  std::vector<Violation> sorted;
  sorted.reserve(order.size());
  for (const std::size_t k : order) sorted.push_back(far.places[k]);
  far.places = std::move(sorted);
}

}  // namespace

DistanceCheck::DistanceCheck(const Surface& surface, const FeatureLines& lines,
                             const Context* context)
    : projector_(surface, false, context), old_(places_of(surface, lines)) {}

FarPlaces DistanceCheck::far_places(const Dual& dual, const Sites& sites, double limit,
                                    const Context* context) const {
  FarPlaces result;
  if (dual.triangles.empty()) return result;
  const Surface mesh = surface_of(sites.positions, dual.triangles);
  std::vector<double> distances;
  add_old(Projector(mesh, false, context), limit, context, result, distances);
  add_new(dual, sites, limit, context, result, distances);
  finish(sites, distances, result);
  return result;
}

void DistanceCheck::add_old(const Projector& mesh, double limit, const Context* context,
                            FarPlaces& result, std::vector<double>& distances) const {
  const Projection found = mesh.project(positions_of(old_), {}, context);
  for (std::size_t k = 0; k < old_.size(); ++k) {
    result.largest = std::max(result.largest, found.distances[k]);
    if (found.distances[k] <= limit) continue;
    result.places.push_back({-1, Flaw::kFar, old_[k], {}});
    distances.push_back(found.distances[k]);
  }
}

void DistanceCheck::add_new(const Dual& dual, const Sites& sites, double limit,
                            const Context* context, FarPlaces& result,
                            std::vector<double>& distances) const {
  const Projection found = projector_.project(
      positions_of(middles_of(dual.triangles, dual.lines, sites.positions)), {}, context);
  for (std::size_t k = 0; k < found.distances.size(); ++k) {
    result.largest = std::max(result.largest, found.distances[k]);
    if (found.distances[k] <= limit) continue;
    result.places.push_back({-1, Flaw::kFar, {found.positions[k], found.faces[k], -1}, {}});
    distances.push_back(found.distances[k]);
  }
}

MeshDistances DistanceCheck::distances(const RemeshResult& mesh, const Context* context) const {
  MeshDistances result{std::vector<double>(mesh.vertices.size(), 0.0)};
  if (mesh.faces.empty()) return result;
  const auto take = [&](std::int32_t vertex, double distance) {
    double& own = result.of_vertices[as_index(vertex)];
    own = std::max(own, distance);
    result.largest = std::max(result.largest, distance);
  };
  const std::vector<Middle> middles = middles_of(mesh.faces, mesh.lines, mesh.vertices);
  const Projection of_middles = projector_.project(positions_of(middles), {}, context);
  for (std::size_t k = 0; k < middles.size(); ++k)
    for (const std::int32_t v : middles[k].of) take(v, of_middles.distances[k]);
  const Surface surface = surface_of(mesh.vertices, mesh.faces);
  const Projection of_old =
      Projector(surface, false, context).project(positions_of(old_), {}, context);
  const Neighbors tree(mesh.vertices);
  std::vector<Neighbor> nearest;
  for (std::size_t k = 0; k < old_.size(); ++k) {
    tree.nearest(old_[k].position, 1, nearest);
    take(nearest[0].index, of_old.distances[k]);
  }
  return result;
}

}  // namespace dapple
