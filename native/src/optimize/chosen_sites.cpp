// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/chosen_sites.hpp"

#include <numeric>
#include <vector>

#include "base/vectors.hpp"

namespace dapple {

Sites select(const Sites& sites, std::span<const std::int32_t> members) {
  Sites result;
  select(sites, members, result);
  return result;
}

Sites select(const Sites& sites, std::span<const std::size_t> members) {
  return select(sites, std::vector<std::int32_t>(members.begin(), members.end()));
}

void select(const Sites& sites, std::span<const std::int32_t> members, Sites& chosen) {
  const bool bound = !sites.barycentric.empty();
  chosen.positions.resize(members.size());
  chosen.faces.resize(members.size());
  chosen.barycentric.resize(bound ? members.size() : 0);
  for_each_vector(members.size(), [&](std::size_t k) {
    const auto site = static_cast<std::size_t>(members[k]);
    chosen.positions[k] = sites.positions[site];
    chosen.faces[k] = sites.faces[site];
    if (bound) chosen.barycentric[k] = sites.barycentric[site];
  });
}

Sites without_first(const Sites& sites, std::size_t count) {
  std::vector<std::int32_t> rest(sites.size() - count);
  std::iota(rest.begin(), rest.end(), static_cast<std::int32_t>(count));
  return select(sites, rest);
}

void put(Sites& sites, std::span<const std::int32_t> members, const Sites& chosen) {
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto site = static_cast<std::size_t>(members[k]);
    sites.positions[site] = chosen.positions[k];
    sites.faces[site] = chosen.faces[k];
    sites.barycentric[site] = chosen.barycentric[k];
  }
}

void append(Sites& sites, const Sites& more) {
  sites.positions.insert(sites.positions.end(), more.positions.begin(), more.positions.end());
  sites.faces.insert(sites.faces.end(), more.faces.begin(), more.faces.end());
  sites.barycentric.insert(sites.barycentric.end(), more.barycentric.begin(),
                           more.barycentric.end());
}

}  // namespace dapple
