// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/delaunay_graph.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Periodic_2_Delaunay_triangulation_2.h>
#include <CGAL/Periodic_2_Delaunay_triangulation_traits_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <tuple>

#include "base/morton.hpp"
#include "base/random.hpp"

// Sites are inserted one by one in an order of our own, since CGAL's ranges are shuffled and its
// dummy points removed in an order that depends on addresses: where four sites lie on a circle,
// another order is another triangulation, and the bytes would differ from run to run.

namespace dapple {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Plane = CGAL::Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<
                CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>>>;

using PeriodicTraits = CGAL::Periodic_2_Delaunay_triangulation_traits_2<Kernel>;
using Torus = CGAL::Periodic_2_Delaunay_triangulation_2<
    PeriodicTraits, CGAL::Triangulation_data_structure_2<
                        CGAL::Triangulation_vertex_base_with_info_2<
                            std::int32_t, PeriodicTraits,
                            CGAL::Periodic_2_triangulation_vertex_base_2<PeriodicTraits>>,
                        CGAL::Periodic_2_triangulation_face_base_2<PeriodicTraits>>>;

// One sheet is possible once no circle without sites is wider than about a third of the square.
// Until then CGAL keeps nine copies of everything, so it is tried with this many scattered sites.
constexpr std::size_t kFewestPeriodic = 30;
constexpr std::size_t kScattered = 250;

struct Arc {
  std::int32_t from;
  SiteGraph::Link link;
};

auto key(const Arc& arc) {
  return std::tuple(arc.from, arc.link.offset.squaredNorm(), arc.link.site, arc.link.offset.x(),
                    arc.link.offset.y());
}

SiteGraph to_graph(std::vector<Arc> arcs, std::size_t count, bool periodic) {
  std::sort(arcs.begin(), arcs.end(), [](const Arc& a, const Arc& b) { return key(a) < key(b); });
  SiteGraph graph;
  graph.periodic = periodic;
  graph.starts.assign(count + 1, 0);
  graph.links.reserve(arcs.size());
  for (const Arc& arc : arcs) {
    ++graph.starts[static_cast<std::size_t>(arc.from) + 1];
    graph.links.push_back(arc.link);
  }
  for (std::size_t k = 0; k < count; ++k) graph.starts[k + 1] += graph.starts[k];
  return graph;
}

/// Sites at different places along a curve in space, and an arc from each other site to the first
/// at its place.
struct Places {
  std::vector<std::int32_t> sites;
  std::vector<Arc> twins;

  explicit Places(std::span<const Vec3> x) {
    std::vector<std::int32_t> sorted(x.size());
    for (std::size_t k = 0; k < x.size(); ++k) sorted[k] = static_cast<std::int32_t>(k);
    const auto place = [&](std::int32_t k) {
      const Vec3& p = x[static_cast<std::size_t>(k)];
      return std::tuple(p.x(), p.y());
    };
    std::sort(sorted.begin(), sorted.end(), [&](std::int32_t a, std::int32_t b) {
      return std::tuple(place(a), a) < std::tuple(place(b), b);
    });
    std::vector<bool> first(x.size(), true);
    for (std::size_t k = 1, leader = 0; k < sorted.size(); ++k) {
      if (place(sorted[k]) != place(sorted[leader])) {
        leader = k;
        continue;
      }
      first[static_cast<std::size_t>(sorted[k])] = false;
      twins.push_back({sorted[k], {sorted[leader], Vec3::Zero()}});
    }
    for (const std::int32_t k : morton_order(x))
      if (first[static_cast<std::size_t>(k)]) sites.push_back(k);
  }
};

/// Bring some sites from all over to the front.
void scatter(std::vector<std::int32_t>& sites) {
  Random random(0);
  for (std::size_t k = 0; k < std::min(kScattered, sites.size()); ++k) {
    const auto rest = static_cast<double>(sites.size() - k);
    std::swap(sites[k], sites[k + static_cast<std::size_t>(random.uniform() * rest)]);
  }
}

Kernel::Point_2 in_plane(const Vec3& p) { return {p.x(), p.y()}; }

/// The periodic triangulation; still of several sheets if the sites leave gaps too wide for one.
Torus triangulate(std::span<const Vec3> x, std::vector<std::int32_t> sites) {
  Torus torus(Torus::Iso_rectangle(0, 0, 1, 1));
  scatter(sites);
  Torus::Face_handle near;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (k == kScattered && !torus.is_1_cover()) break;
    const auto vertex = torus.insert(in_plane(x[static_cast<std::size_t>(sites[k])]), near);
    vertex->info() = sites[k];
    near = vertex->face();
  }
  return torus;
}

void add_arcs(const Torus& torus, std::vector<Arc>& arcs) {
  const auto place = [&](Torus::Face_handle face, int k) {
    const auto& p = face->vertex(k)->point();
    const auto offset = torus.get_offset(face, k);
    return Vec3(p.x() + offset.x(), p.y() + offset.y(), 0.0);
  };
  for (auto face = torus.faces_begin(); face != torus.faces_end(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int next = Torus::ccw(k);
      arcs.push_back({face->vertex(k)->info(),
                      {face->vertex(next)->info(), place(face, next) - place(face, k)}});
    }
}

/// The offset of one of the nine tiles, in rows of three around the middle one.
Vec3 shift_of(std::int32_t tile) {
  const std::int32_t column = tile % 3 - 1;
  const std::int32_t row = tile / 3 - 1;
  return {double(column), double(row), 0.0};
}

/// The neighbors of sites in the unit square from a plane triangulation of the square and the
/// eight images around it: more there need not be, since a site's own images hold its cell within
/// half a period of it.
void add_arcs_of_images(std::span<const Vec3> x, std::span<const std::int32_t> sites,
                        std::vector<Arc>& arcs) {
  constexpr std::int32_t kTiles = 9, kMiddle = 4;
  Plane plane;
  Plane::Face_handle near;
  for (std::int32_t tile = 0; tile < kTiles; ++tile)
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const Vec3 shift = shift_of(tile);
      const auto vertex =
          plane.insert(in_plane(x[static_cast<std::size_t>(sites[k])] + shift), near);
      vertex->info() = static_cast<std::int32_t>(k) * kTiles + tile;
      near = vertex->face();
    }
  const auto add = [&](std::int32_t from, std::int32_t to) {
    if (from % kTiles != kMiddle) return;
    const std::int32_t i = sites[static_cast<std::size_t>(from / kTiles)];
    const std::int32_t j = sites[static_cast<std::size_t>(to / kTiles)];
    const Vec3 shift = shift_of(to % kTiles);
    const Vec3 offset = x[static_cast<std::size_t>(j)] + shift - x[static_cast<std::size_t>(i)];
    arcs.push_back({i, {j, Vec3(offset.x(), offset.y(), 0.0)}});
  };
  for (const auto& [face, k] : plane.finite_edges()) {
    const std::int32_t a = face->vertex(Plane::cw(k))->info();
    const std::int32_t b = face->vertex(Plane::ccw(k))->info();
    add(a, b);
    add(b, a);
  }
}

}  // namespace

SiteGraph plane_graph(std::span<const Vec3> x) {
  Places places(x);
  Plane plane;
  Plane::Face_handle near;
  for (const std::int32_t k : places.sites) {
    const auto vertex = plane.insert(in_plane(x[static_cast<std::size_t>(k)]), near);
    vertex->info() = k;
    near = vertex->face();
  }
  std::vector<Arc> arcs = std::move(places.twins);
  for (const auto& [face, k] : plane.finite_edges()) {
    const std::int32_t a = face->vertex(Plane::cw(k))->info();
    const std::int32_t b = face->vertex(Plane::ccw(k))->info();
    const Vec3 offset = x[static_cast<std::size_t>(b)] - x[static_cast<std::size_t>(a)];
    arcs.push_back({a, {b, offset}});
    arcs.push_back({b, {a, -offset}});
  }
  return to_graph(std::move(arcs), x.size(), false);
}

SiteGraph torus_graph(std::span<const Vec3> x) {
  Places places(x);
  std::vector<Arc> arcs = std::move(places.twins);
  bool periodic = false;
  if (places.sites.size() >= kFewestPeriodic) {
    const Torus torus = triangulate(x, places.sites);
    periodic = torus.is_1_cover() && torus.number_of_vertices() == places.sites.size();
    if (periodic) add_arcs(torus, arcs);
  }
  if (!periodic) add_arcs_of_images(x, places.sites, arcs);
  return to_graph(std::move(arcs), x.size(), true);
}

}  // namespace dapple
