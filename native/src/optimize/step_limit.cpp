// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/step_limit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

// The spacing divided by a cell's root mean square distance from its site, which is sqrt(5) / 6
// spacings for a regular hexagon.
constexpr double kSpread = 2.6832815729997477;
constexpr double kLong = 2.0;   // spacings: a cell that is longer may be thin
constexpr double kThin = 0.18;  // ratio of the area to the squared length; 0.87 for a hexagon

/// The spacing, or the length of the cell on parts thinner than the spacing, where sites are far
/// more than a spacing apart. Cells that are large in all directions have too few sites around
/// them.
double reach(const Objective& objective, const Evaluation& state, std::size_t k) {
  const Moments& cell = state.diagram().cells[k];
  const double spacing = local_spacing(objective, state, 0, k);
  const double length = cell.mass > 0.0 ? kSpread * std::sqrt(cell.second / cell.mass) : 0.0;
  const bool thin = length > kLong * spacing && cell.area < kThin * length * length;
  return thin ? length : spacing;
}

}  // namespace

double longest_step(const Objective& objective, const Evaluation& state, double max_step,
                    std::size_t k) {
  return std::max(max_step * reach(objective, state, k), std::numeric_limits<double>::min());
}

double step_excess(const Objective& objective, const Evaluation& state, double max_step,
                   const Vectors& moves) {
  double excess = 0.0;
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (state.diagram().cells[k].capacity > 0.0)
      excess = std::max(excess, moves[k].norm() / longest_step(objective, state, max_step, k));
  return excess;
}

}  // namespace dapple
