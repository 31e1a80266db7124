// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace dapple {

/// Share out `count` in proportion to the weights, by largest remainders, ties to the first.
inline std::vector<std::size_t> allot(std::span<const double> weights, std::size_t count) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<std::size_t> quotas(weights.size());
  std::vector<std::pair<double, std::size_t>> remainders;
  std::size_t given = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double share = static_cast<double>(count) * weights[k] / total;
    given += quotas[k] = static_cast<std::size_t>(share);
    remainders.emplace_back(static_cast<double>(quotas[k]) - share, k);
  }
  std::sort(remainders.begin(), remainders.end());
  for (std::size_t k = 0; given < count; ++given, ++k)
    ++quotas[remainders[k % remainders.size()].second];
  return quotas;
}

}  // namespace dapple
