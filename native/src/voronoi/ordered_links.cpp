// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/ordered_links.hpp"

namespace dapple {

void OrderedLinks::assign(const OrderedSites& sites, const SiteGraph* graph) {
  sites_ = &sites;
  graph_ = graph;
  if (!graph) return;
  ordered_.resize(sites.size());
  for (std::size_t k = 0; k < ordered_.size(); ++k)
    ordered_[as_index(sites.originals[k])] = static_cast<std::int32_t>(k);
}

// In a Delaunay triangulation every site but the nearest has a neighbor that is nearer.
std::int32_t OrderedLinks::nearest(const Vec3& point, std::int32_t from) const {
  const auto squared_distance = [&](std::int32_t site) {
    return (sites_->position(site) - point).squaredNorm();
  };
  double best = squared_distance(from);
  for (bool moved = true; moved;) {
    moved = false;
    for (const SiteGraph::Link& link : of(from)) {
      const std::int32_t j = ordered(link.site);
      const double squared = squared_distance(j);
      if (squared > best || (squared == best && link.site >= sites_->original(from))) continue;
      best = squared;
      from = j;
      moved = true;
      break;
    }
  }
  return from;
}

}  // namespace dapple
