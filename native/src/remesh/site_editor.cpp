// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/site_editor.hpp"

#include <algorithm>
#include <numeric>

#include "base/segment.hpp"
#include "base/triangle.hpp"
#include "lines/line_sites.hpp"
#include "optimize/chosen_sites.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kApart = 0.5;  // of a place's distance from its site: edits that are too close
constexpr double kFarApart = 4.0, kDenseApart = 1.0;
constexpr double kBeside = 1.0;  // the same for places that are far from the mesh
constexpr double kAway = 1e-6;   // of the spacing, a place that is no other than its site

Sites site_at(const Surface& surface, const Place& place) {
  const OrderedSurface& mesh = surface.ordered();
  const auto& [a, b, c] = mesh.corners(mesh.ordered_face(place.face));
  if (const std::int32_t h = place.half_edge; h >= 0) {
    const std::array<Vec3, 3> p = {mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)};
    const Vec3 &from = p[as_index(h % 3)], &to = p[as_index((h + 1) % 3)];
    return point_on_edge(mesh, h, nearest_share(place.position, from, to));
  }
  const Vec3 weights =
      closest_barycentric(place.position, mesh.vertex(a), mesh.vertex(b), mesh.vertex(c));
  return {{mesh.point(mesh.ordered_face(place.face), weights)}, {place.face}, {weights}};
}

/// The point of another chain as far from a corner that it shares with the site's: cells of points
/// that mirror each other end between the two lines, however acute their angle is. None without
/// such a corner.
Sites mirrored(const Surface& surface, const FeatureLines& lines, std::int32_t own,
               std::int32_t other, const Vec3& site, const Vec3& near) {
  Sites found;
  if (own < 0 || other < 0) return found;
  const LineChain &a = lines.chains()[as_index(own)], &b = lines.chains()[as_index(other)];
  if (a.closed || b.closed) return found;
  double least = (near - site).norm();  // from the place that is to be covered
  for (const std::int32_t v : {a.vertices.front(), a.vertices.back()})
    for (const bool forward : {true, false}) {
      if (v != (forward ? b.vertices.front() : b.vertices.back())) continue;
      const Sites made = point_on_chain(surface.ordered(), b, forward,
                                        (surface.ordered().vertex(v) - site).norm());
      if (made.size() == 0 || (made.positions[0] - near).norm() > least) continue;
      least = (made.positions[0] - near).norm();
      found = made;
    }
  return found;
}

/// Whether a site is at a place already.
bool is_taken(const RemeshSites& sites, const Sites& place, double tolerance) {
  return std::ranges::any_of(sites.sites.positions, [&](const Vec3& position) {
    return (position - place.positions[0]).norm() <= tolerance;
  });
}

/// One violation of each site: lines first.
std::vector<Violation> first_of_each(std::span<const Violation> violations) {
  std::vector<Violation> sorted(violations.begin(), violations.end());
  std::ranges::stable_sort(sorted, [](const Violation& a, const Violation& b) {
    return std::pair(a.site, a.flaw) < std::pair(b.site, b.flaw);
  });
  const auto rest = std::ranges::unique(sorted, {}, &Violation::site);
  sorted.erase(rest.begin(), rest.end());
  std::ranges::stable_sort(sorted, {}, &Violation::flaw);
  return sorted;
}

}  // namespace

bool RemeshSites::stay(const Face& triangle) const {
  return std::ranges::all_of(triangle, [&](std::int32_t v) { return origins[as_index(v)].stays; });
}

void RemeshSites::add(const Sites& more, SiteKind kind, std::int32_t chain, bool pin,
                      Origin origin) {
  for (std::size_t k = 0; k < more.size(); ++k) {
    sites.positions.push_back(more.positions[k]);
    sites.faces.push_back(more.faces[k]);
    sites.barycentric.push_back(more.barycentric[k]);
    kinds.push_back(kind);
    chains.push_back(chain);
    pinned.push_back(pin);
    origins.push_back(origin);
  }
}

RemeshSites RemeshSites::chosen(std::span<const std::size_t> members) const {
  RemeshSites result;
  result.sites = select(sites, members);
  for (const std::size_t k : members) {
    result.kinds.push_back(kinds[k]);
    result.chains.push_back(chains[k]);
    result.pinned.push_back(pinned[k]);
    result.origins.push_back(origins[k]);
  }
  return result;
}

void RemeshSites::move(std::size_t site, const Sites& to, SiteKind kind, std::int32_t chain) {
  sites.positions[site] = to.positions[0];
  sites.faces[site] = to.faces[0];
  sites.barycentric[site] = to.barycentric[0];
  kinds[site] = kind;
  chains[site] = chain;
  origins[site].stays = false;
}

std::size_t mend(const Surface& surface, const FeatureLines& lines,
                 std::span<const Violation> violations, RemeshSites& sites, bool dense) {
  struct Edit {
    Vec3 position;
    double reach;
  };
  std::vector<Edit> edits;
  // Other flaws may vanish with those at lines.
  const auto is_near = [&](const Vec3& p, double reach, Flaw flaw) {
    const double apart = flaw == Flaw::kForeignLine ? kApart
                         : flaw >= Flaw::kFar       ? kBeside
                         : dense                    ? kDenseApart
                                                    : kFarApart;
    return std::ranges::any_of(edits, [&](const Edit& edit) {
      return (edit.position - p).norm() < apart * std::max(reach, edit.reach);
    });
  };
  const double least = kAway * surface.spacing(sites.size());
  for (const Violation& violation : first_of_each(violations)) {
    const auto site = as_index(violation.site);
    const bool snaps = violation.flaw == Flaw::kForeignLine && sites.kinds[site] == SiteKind::kFree;
    // The opposite place: refining a line between two others would not end where these meet.
    const Place& place = violation.flaw == Flaw::kForeignLine ? violation.nearest : violation.place;
    const double reach = (place.position - sites.sites.positions[site]).norm();
    if ((!snaps && reach <= least) || is_near(place.position, reach, violation.flaw)) continue;
    edits.push_back({place.position, reach});
    const std::int32_t chain = place.half_edge >= 0 ? lines.chain_of(place.half_edge) : -1;
    const SiteKind kind = chain >= 0 ? SiteKind::kLine : SiteKind::kFree;
    if (snaps) {
      sites.move(site, site_at(surface, place), kind, chain);
      continue;
    }
    Sites made;
    if (violation.flaw == Flaw::kForeignLine)
      made = mirrored(surface, lines, sites.chains[site], chain, sites.sites.positions[site],
                      place.position);
    // A second site at a place mends nothing.
    if (made.size() == 0 || is_taken(sites, made, least)) made = site_at(surface, place);
    sites.add(made, kind, chain, true);
  }
  return edits.size();
}

std::vector<bool> widened(std::span<const Face> triangles, std::vector<bool> marked, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<bool> next = marked;
    for (const auto& [a, b, c] : triangles)
      if (marked[as_index(a)] || marked[as_index(b)] || marked[as_index(c)])
        next[as_index(a)] = next[as_index(b)] = next[as_index(c)] = true;
    marked = std::move(next);
  }
  return marked;
}

std::size_t thin_out(const Dual& dual, std::size_t excess, RemeshSites& sites,
                     std::size_t skipped) {
  std::vector<bool> kept(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) kept[k] = sites.pinned[k] || !sites.is_free(k);
  kept = widened(dual.triangles, std::move(kept), 1);
  std::vector<double> areas(sites.size(), 0.0);
  std::vector<std::vector<std::int32_t>> neighbors(sites.size());
  for (const Face& t : dual.triangles) {
    const std::array<Vec3, 3> p = {sites.sites.positions[as_index(t[0])],
                                   sites.sites.positions[as_index(t[1])],
                                   sites.sites.positions[as_index(t[2])]};
    const double area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    for (std::size_t k = 0; k < 3; ++k) {
      areas[as_index(t[k])] += area;
      neighbors[as_index(t[k])].push_back(t[(k + 1) % 3]);
      neighbors[as_index(t[k])].push_back(t[(k + 2) % 3]);
    }
  }
  std::vector<std::size_t> order(sites.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return areas[k]; });
  std::vector<bool> gone(sites.size(), false);
  std::size_t removed = 0;
  for (const std::size_t k : order) {
    if (removed == excess) break;
    if (kept[k]) continue;
    if (skipped > 0) {
      --skipped;
      continue;
    }
    gone[k] = true;
    ++removed;
    for (const std::int32_t n : neighbors[k]) kept[as_index(n)] = true;
  }
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (!gone[k]) left.push_back(k);
  sites = sites.chosen(left);
  return removed;
}

}  // namespace dapple
