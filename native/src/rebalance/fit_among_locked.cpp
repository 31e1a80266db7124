// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/fit_among_locked.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "optimize/chosen_sites.hpp"
#include "rebalance/among_locked.hpp"
#include "rebalance/rebalance.hpp"
#include "rebalance/widest_gaps.hpp"

namespace dapple {
namespace {

/// Remove sites with the smallest cells, except locked ones, until the count is reached.
void keep_to_count(std::size_t count, const std::vector<double>& capacities,
                   const std::vector<bool>& locked, std::vector<std::size_t>& stay) {
  const auto room = [&](std::size_t k) {
    return locked[k] ? std::numeric_limits<double>::infinity() : capacities[k];
  };
  while (stay.size() > count)
    stay.erase(std::min_element(stay.begin(), stay.end(),
                                [&](std::size_t a, std::size_t b) { return room(a) < room(b); }));
}

std::vector<double> capacities_of(const RestrictedVoronoi& diagram) {
  std::vector<double> result;
  result.reserve(diagram.cells.size());
  for (const Moments& cell : diagram.cells) result.push_back(cell.capacity);
  return result;
}

}  // namespace

FittedSites fit_among_locked(const Surface& surface, const Domain& domain, const Sites& sites,
                             const std::vector<bool>& locked, std::size_t count, std::uint64_t seed,
                             Context* context) {
  std::vector<bool> free = locked;
  free.flip();
  RestrictedVoronoi diagram = domain.cells(sites, context);
  const std::vector<double> capacities = capacities_of(diagram);
  const SharedCells shared{diagram.cells, std::vector<bool>(sites.size(), true), locked};
  const double capacity = capacity_for(shared, count);
  Thinned thinned = thin_out(surface, domain, sites, {free, capacity, std::move(diagram)}, context);
  keep_to_count(count, capacities, locked, thinned.stay);
  const Sites left = select(sites, thinned.stay);
  Sites fresh = widest_gaps(surface, {left, std::vector<bool>(left.size(), true), capacity},
                            count - left.size(), seed, context);
  return {std::move(thinned.stay), std::move(fresh), thinned.evaluations + 1};
}

}  // namespace dapple
