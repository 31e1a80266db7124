// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/turnover.hpp"

#include <algorithm>
#include <dapple/poisson_start.hpp>

#include "rebalance/rebalance.hpp"

namespace dapple {
namespace {

constexpr double kShare =
    0.005;  // share of the samples that are exchanged although the area is constant

double apart(std::size_t a, std::size_t b) {
  return static_cast<double>(std::max(a, b) - std::min(a, b));
}

/// The number of samples that may be exchanged in addition to those that have lost their surface.
std::size_t spare_pairs(std::size_t before, std::size_t there, std::size_t count) {
  const double needed = apart(before, there) + apart(there, count);
  const double most = apart(before, count) + kShare * static_cast<double>(before);
  return static_cast<std::size_t>(std::max(0.0, 0.5 * (most - needed)));
}

}  // namespace

Turnover turn_over(const Surface& surface, const Domain& domain, const Transferred& there,
                   std::size_t before, std::size_t count, std::uint64_t seed, Context* context) {
  if (there.which.empty() || count == 0)
    return {poisson_start(surface, count, seed, context), std::vector<std::int32_t>(count, -1)};
  const Rebalanced found =
      rebalance(domain, there.sites, count, seed, context,
                surface.uniform() ? spare_pairs(before, there.which.size(), count) : kAnyNumber);
  Turnover result;
  const auto add = [&](const Sites& from, std::size_t k, std::int32_t origin) {
    result.sites.positions.push_back(from.positions[k]);
    result.sites.faces.push_back(from.faces[k]);
    result.sites.barycentric.push_back(from.barycentric[k]);
    result.origin.push_back(origin);
  };
  for (const std::size_t k : found.stay) add(there.sites, k, there.which[k]);
  for (std::size_t k = 0; k < found.fresh.size(); ++k) add(found.fresh, k, -1);
  return result;
}

}  // namespace dapple
