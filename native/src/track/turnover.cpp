// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/turnover.hpp"

#include <algorithm>
#include <dapple/analysis.hpp>
#include <dapple/poisson_start.hpp>

#include "rebalance/rebalance.hpp"

namespace dapple {
namespace {

// Share of the samples that are exchanged although the area is constant, if the capacities vary by
// more than kUneven; with less, samples that only move end up more even.
constexpr double kShare = 0.005, kUneven = 0.1;

double apart(std::size_t a, std::size_t b) {
  return static_cast<double>(std::max(a, b) - std::min(a, b));
}

/// The number of samples that may be exchanged in addition to those that have lost their surface.
/// \param uneven whether the samples that are left are uneven
std::size_t spare_pairs(std::size_t before, std::size_t there, std::size_t count, bool uneven) {
  const double needed = apart(before, there) + apart(there, count);
  const double share = uneven ? kShare : 0.0;
  const double most = apart(before, count) + share * static_cast<double>(before);
  return static_cast<std::size_t>(std::max(0.0, 0.5 * (most - needed)));
}

}  // namespace

Turnover turn_over(const Surface& surface, const Domain& domain, const Transferred& there,
                   std::size_t before, std::size_t count, std::uint64_t seed, Context* context) {
  if (there.which.empty() || count == 0)
    return {poisson_start(surface, count, seed, context), std::vector<std::int32_t>(count, -1)};
  std::size_t pairs = kAnyNumber;
  if (surface.uniform()) {
    const Evenness now = measure_evenness(domain.cells(there.sites, context));
    pairs = spare_pairs(before, there.which.size(), count, now.capacity_variation > kUneven);
  }
  const Rebalanced found = rebalance(domain, there.sites, count, seed, context, pairs);
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
