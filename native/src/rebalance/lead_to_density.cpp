// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/lead_to_density.hpp"

#include <algorithm>

#include "base/vectors.hpp"
#include "surface/on_density.hpp"

namespace dapple {

void lead_to_density(const Surface& surface, const Domain& domain, Sites& sites,
                     const std::vector<bool>& fixed) {
  if (surface.uniform()) return;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if ((!fixed.empty() && fixed[k]) ||
        is_on_density(surface, sites.faces[k], sites.barycentric[k]))
      continue;
    const Sites found = domain.project(std::span(sites.positions).subspan(k, 1), {});
    sites.positions[k] = found.positions[0];
    sites.faces[k] = found.faces[0];
    sites.barycentric[k] = found.barycentric[0];
  }
}

std::vector<std::size_t> lead_near_ones(const Surface& surface, const Domain& domain, Sites& sites,
                                        const Led& led, const Context* context) {
  std::vector<std::size_t> stay, stranded;
  Vectors positions;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const bool stays = surface.uniform() || led.fixed[k] ||
                       is_on_density(surface, sites.faces[k], sites.barycentric[k]);
    (stays ? stay : stranded).push_back(k);
    if (!stays) positions.push_back(sites.positions[k]);
  }
  if (stranded.empty()) return stay;
  const Sites found = domain.project(positions, {}, context);
  std::vector<double> ways;
  for (std::size_t j = 0; j < stranded.size(); ++j)
    ways.push_back((found.positions[j] - positions[j]).norm());
  const auto nearest =
      static_cast<std::size_t>(std::min_element(ways.begin(), ways.end()) - ways.begin());
  for (std::size_t j = 0; j < stranded.size(); ++j) {
    if (ways[j] > led.reach && !(led.keeps_one && j == nearest)) continue;
    const std::size_t k = stranded[j];
    sites.positions[k] = found.positions[j];
    sites.faces[k] = found.faces[j];
    sites.barycentric[k] = found.barycentric[j];
    stay.push_back(k);
  }
  std::sort(stay.begin(), stay.end());
  return stay;
}

}  // namespace dapple
