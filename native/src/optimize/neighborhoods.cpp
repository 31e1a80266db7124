// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/neighborhoods.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace dapple {

void make_unique(Chosen& sites) {
  std::sort(sites.begin(), sites.end());
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
}

Chosen with_rings(const RestrictedVoronoi& diagram, const Chosen& sites, int rings) {
  Chosen result = sites, ring = sites;
  for (int r = 0; r < rings; ++r) {
    Chosen next;
    for (const std::size_t k : ring)
      for (const CellBoundary& side : diagram.boundary(k))
        next.push_back(static_cast<std::size_t>(side.neighbor));
    make_unique(next);
    ring.clear();
    std::ranges::set_difference(next, result, std::back_inserter(ring));
    result.insert(result.end(), ring.begin(), ring.end());
    make_unique(result);
  }
  return result;
}

std::vector<bool> around(const RestrictedVoronoi& diagram, const Chosen& sites, int rings) {
  std::vector<bool> result(diagram.cells.size(), false);
  for (const std::size_t k : with_rings(diagram, sites, rings)) result[k] = true;
  return result;
}

std::vector<Chosen> places_of(const RestrictedVoronoi& diagram, const Chosen& sites, int rings) {
  const std::vector<bool> near = around(diagram, sites, rings);
  std::vector<bool> seen(near.size(), false);
  std::vector<Chosen> result;
  for (const std::size_t site : sites) {
    if (seen[site]) continue;
    Chosen place = {site};
    seen[site] = true;
    for (std::size_t k = 0; k < place.size(); ++k)
      for (const CellBoundary& side : diagram.boundary(place[k])) {
        const auto j = static_cast<std::size_t>(side.neighbor);
        if (near[j] && !seen[j]) place.push_back(j);
        seen[j] = true;
      }
    std::erase_if(
        place, [&](std::size_t k) { return !std::binary_search(sites.begin(), sites.end(), k); });
    std::sort(place.begin(), place.end());
    result.push_back(std::move(place));
  }
  return result;
}

}  // namespace dapple
