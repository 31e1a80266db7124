// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/among_locked.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

// Capacity of a locked sample, relative to the target, below which the locked samples are crowded
// and other samples cannot compensate for it.
constexpr double kCrowded = 0.25;
constexpr int kHalvings = 60;

/// The number of samples that fit a locked sample's cell, itself included.
/// \param share the target capacity of a sample
double asked_by_locked(double share) {
  return share + std::max(0.0, (1.0 - share - kCrowded) / (1.0 - kCrowded));
}

}  // namespace

double asked_for(const SharedCells& shared, double capacity) {
  double sum = 0.0;
  for (std::size_t k = 0; k < shared.cells.size(); ++k) {
    const double share = shared.cells[k].capacity / capacity;
    if (shared.open[k]) sum += shared.locked[k] ? asked_by_locked(share) : share;
  }
  return sum;
}

double capacity_for(const SharedCells& shared, std::size_t count) {
  double sum = 0.0;
  for (std::size_t k = 0; k < shared.cells.size(); ++k)
    if (shared.open[k]) sum += shared.cells[k].capacity;
  const auto wanted = static_cast<double>(count);
  double low = sum / wanted, high = low;
  const auto is_crowded = [&](std::size_t k) {
    return shared.open[k] && shared.locked[k] && shared.cells[k].capacity < (1.0 - kCrowded) * low;
  };
  bool crowded = false;
  for (std::size_t k = 0; k < shared.cells.size(); ++k) crowded = crowded || is_crowded(k);
  if (!crowded) return low;
  while (high < sum && asked_for(shared, high) > wanted) high *= 2.0;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (asked_for(shared, middle) > wanted ? low : high) = middle;
  }
  return high;
}

std::size_t lacking_beside_locked(const SharedCells& shared, double capacity) {
  double room = 0.0;
  for (std::size_t k = 0; k < shared.cells.size(); ++k)
    if (shared.open[k] && shared.locked[k])
      room += asked_by_locked(shared.cells[k].capacity / capacity) - 1.0;
  return static_cast<std::size_t>(std::llround(std::max(room, 0.0)));
}

}  // namespace dapple
