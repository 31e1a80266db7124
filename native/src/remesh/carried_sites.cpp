// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/carried_sites.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/domain.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <tuple>

#include "base/hexagonal.hpp"
#include "lines/line_places.hpp"
#include "lines/line_sites.hpp"
#include "optimize/chosen_sites.hpp"
#include "rebalance/fit_among_locked.hpp"
#include "remesh/unchanged.hpp"
#include "surface/ordered_surface.hpp"
#include "track/transfer.hpp"

namespace dapple {
namespace {

constexpr double kSame = 1e-4;   // spacings: a smaller motion is no change
constexpr double kReach = 1.0;   // spacings that a vertex may be away from the next surface
constexpr double kBeside = 0.5;  // spacings: vertices nearer to new ones on lines are these, or go

Sites vertices_of(const RemeshResult& mesh) {
  return {mesh.vertices, mesh.source_faces, mesh.barycentric};
}

Sites nth(const Sites& sites, std::size_t k) {
  return {{sites.positions[k]}, {sites.faces[k]}, {sites.barycentric[k]}};
}

class Carrier {
 public:
  Carrier(const Surface& before, const RemeshResult& mesh, const NextSurface& next,
          const RemeshOptions& options, Context* context)
      : before_(before), mesh_(mesh), next_(next), options_(options), context_(context) {}

  CarriedSites run() {
    keep_unchanged();
    const std::size_t stay = result_.sites.size();
    add_on_lines();
    carry_others(stay);
    fit(stay);
    return std::move(result_);
  }

 private:
  /// The distance of neighbors at a place of the next surface.
  [[nodiscard]] double spacing_at(const Sites& sites, std::size_t k) const {
    const OrderedSurface& mesh = next_.surface.ordered();
    const double density =
        sites.barycentric[k].dot(mesh.densities(mesh.counted_face(sites.faces[k])));
    return density > 0.0 ? hexagonal_spacing(next_.capacity / density) : 0.0;
  }

  void keep_unchanged() {
    const double least = hexagonal_spacing(next_.capacity * before_.area() / before_.capacity());
    const double tolerance = kSame * least;
    unchanged_ = unchanged_vertices(before_, mesh_, next_.surface, tolerance, context_);
    const LinePlaces lines(next_.surface, next_.lines);
    kept_.corners.assign(next_.lines.corners().size(), false);
    kept_.places.resize(next_.lines.chains().size());
    const Projection& found = unchanged_.places;
    for (std::size_t k = 0; k < mesh_.vertices.size(); ++k) {
      if (!unchanged_.vertices[k]) continue;
      Sites site = {{found.positions[k]}, {found.faces[k]}, {found.barycentric[k]}};
      const LinePlace on = lines.find(site.faces[0], site.positions[0], tolerance);
      if (on.is_on_line()) site = lines.site_at(on);  // exactly
      if (on.corner >= 0) kept_.corners[as_index(on.corner)] = true;
      if (on.chain >= 0) kept_.places[as_index(on.chain)].push_back({on.edge, on.share});
      add(site, SiteKind::kFree, {static_cast<std::int32_t>(k), true});
    }
  }

  void add(const Sites& site, SiteKind kind, Origin origin) {
    result_.sites.add(site, kind, -1, false, origin);
  }

  void add_on_lines() {
    add(sites_on_lines(next_.surface, next_.lines, next_.line_spacing, kept_).sites,
        SiteKind::kLine, {});
  }

  /// \param stay sites; those on lines come after them
  void carry_others(std::size_t stay) {
    const Transfer transfer(before_, next_.surface, vertices_of(mesh_),
                            {1.0 / next_.capacity, kReach}, context_);
    const Transferred& there = transfer.samples();
    std::vector<bool> taken = name_new(there, stay);
    take_beside(there, taken);
    for (std::size_t k = 0; k < there.which.size(); ++k)
      if (!taken[k] && !unchanged_.vertices[as_index(there.which[k])])
        add(nth(there.sites, k), SiteKind::kFree, {there.which[k], false});
  }

  /// Mark vertices that are beside sites placed so far.
  void take_beside(const Transferred& there, std::vector<bool>& taken) const {
    if (result_.sites.size() == 0) return;
    const Neighbors tree(result_.sites.sites.positions);
    std::vector<Neighbor> nearest;
    for (std::size_t k = 0; k < there.which.size(); ++k) {
      tree.nearest(there.sites.positions[k], 1, nearest);
      const double least = kBeside * spacing_at(there.sites, k);
      if (nearest[0].squared_distance < least * least) taken[k] = true;
    }
  }

  /// New sites on lines continue vertices that were on lines and are nearest to them, each one.
  /// \return per vertex that has a place whether it goes on as one of them
  std::vector<bool> name_new(const Transferred& there, std::size_t stay) {
    std::vector<bool> taken(there.which.size(), false);
    RemeshSites& sites = result_.sites;
    if (sites.size() == stay) return taken;
    const Neighbors tree(std::span(sites.sites.positions).subspan(stay));
    using Pair = std::tuple<double, std::size_t, std::size_t>;  // squared distance, vertex, site
    std::vector<Pair> pairs;
    std::vector<Neighbor> nearest;
    for (std::size_t k = 0; k < there.which.size(); ++k) {
      const auto vertex = as_index(there.which[k]);
      if (unchanged_.vertices[vertex] || mesh_.features[vertex] == VertexFeature::kFace) continue;
      tree.nearest(there.sites.positions[k], 1, nearest);
      const double most = kBeside * spacing_at(there.sites, k);
      if (nearest[0].squared_distance < most * most)
        pairs.emplace_back(nearest[0].squared_distance, k, stay + as_index(nearest[0].index));
    }
    std::ranges::sort(pairs);
    for (const auto& [_, k, site] : pairs) {
      if (sites.origins[site].vertex >= 0) continue;
      sites.origins[site].vertex = there.which[k];
      taken[k] = true;
    }
    return taken;
  }

  /// As many vertices as what has changed asks for.
  void fit(std::size_t stay) {
    RemeshSites& sites = result_.sites;
    if (sites.size() == 0) return;
    std::vector<bool> locked;
    for (std::size_t k = 0; k < sites.size(); ++k)
      locked.push_back(sites.origins[k].stays || sites.kinds[k] == SiteKind::kLine);
    const double changed = next_.surface.capacity() - capacity_of_unchanged();
    const auto more =
        static_cast<std::size_t>(std::max(std::llround(changed / next_.capacity), 0LL));
    const auto fixed = static_cast<std::size_t>(std::ranges::count(locked, true));
    const std::size_t count = std::max({stay + more, fixed, std::size_t{1}});
    if (count == fixed && fixed == sites.size()) return;
    const SurfaceDomain domain(next_.surface, options_.cells);
    const FittedSites fitted = fit_among_locked(next_.surface, domain, sites.sites, locked, count,
                                                options_.seed, context_);
    sites = sites.chosen(fitted.stay);
    sites.add(fitted.fresh, SiteKind::kFree, -1, false);
    result_.evaluations += fitted.evaluations;
  }

  /// Of the cells of vertices that stay, on the surface before.
  [[nodiscard]] double capacity_of_unchanged() const {
    if (std::ranges::find(unchanged_.vertices, true) == unchanged_.vertices.end()) return 0.0;
    const RestrictedVoronoi diagram =
        restricted_voronoi(before_, vertices_of(mesh_), options_.cells, context_);
    double all = 0.0, own = 0.0;
    for (std::size_t k = 0; k < diagram.cells.size(); ++k) {
      all += diagram.cells[k].capacity;
      if (unchanged_.vertices[k]) own += diagram.cells[k].capacity;
    }
    return before_.capacity() * own / all;
  }

  const Surface& before_;
  const RemeshResult& mesh_;
  const NextSurface& next_;
  const RemeshOptions& options_;
  Context* context_;
  Unchanged unchanged_;
  KeptOnLines kept_;
  CarriedSites result_;
};

}  // namespace

CarriedSites carry_sites(const Surface& before, const RemeshResult& mesh, const NextSurface& next,
                         const RemeshOptions& options, Context* context) {
  return Carrier(before, mesh, next, options, context).run();
}

}  // namespace dapple
