// SPDX-License-Identifier: GPL-3.0-or-later
#include "site_index.hpp"

#include <algorithm>
#include <numeric>

namespace dapple {

OrderedSites::OrderedSites(const Surface& surface, const Sites& sites) : originals(sites.size()) {
  std::vector<std::int32_t> ordered(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) ordered[k] = surface.ordered_face(sites.faces[k]);
  std::iota(originals.begin(), originals.end(), 0);
  std::sort(originals.begin(), originals.end(), [&](std::int32_t a, std::int32_t b) {
    const std::int32_t fa = ordered[static_cast<std::size_t>(a)];
    const std::int32_t fb = ordered[static_cast<std::size_t>(b)];
    return fa != fb ? fa < fb : a < b;
  });
  for (const std::int32_t k : originals) {
    positions.push_back(sites.positions[static_cast<std::size_t>(k)]);
    faces.push_back(ordered[static_cast<std::size_t>(k)]);
  }
}

SiteIndex::SiteIndex(const OrderedSites& sites, const SiteGraph* graph)
    : sites_(&sites), graph_(graph) {
  if (!graph) {
    tree_.emplace(sites.positions);
    return;
  }
  ordered_.resize(sites.size());
  for (std::size_t k = 0; k < ordered_.size(); ++k)
    ordered_[static_cast<std::size_t>(sites.originals[k])] = static_cast<std::int32_t>(k);
}

std::int32_t SiteIndex::nearest(const Vec3& point, std::int32_t from) const {
  if (!tree_) return walk(point, from);
  std::vector<Neighbour> found;
  tree_->nearest(point, 1, found);
  return found[0].index;
}

// In a Delaunay triangulation every site but the nearest has a neighbour that is nearer.
std::int32_t SiteIndex::walk(const Vec3& point, std::int32_t site) const {
  double best = squared_distance(point, site);
  for (bool moved = true; moved;) {
    moved = false;
    for (const SiteGraph::Link& link : links(site)) {
      const std::int32_t j = ordered(link.site);
      const double squared = squared_distance(point, j);
      if (squared > best || (squared == best && link.site >= sites_->original(site))) continue;
      best = squared;
      site = j;
      moved = true;
      break;
    }
  }
  return site;
}

}  // namespace dapple
