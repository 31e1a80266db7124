// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/step_limit.hpp"

#include <algorithm>
#include <limits>

namespace dapple {

double longest_step(const Objective& objective, const State& state, double max_step,
                    std::size_t k) {
  return std::max(max_step * local_spacing(objective, state, 0, k),
                  std::numeric_limits<double>::min());
}

double step_excess(const Objective& objective, const State& state, double max_step,
                   const Vectors& moves) {
  double excess = 0.0;
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (state.diagram().cells[k].capacity > 0.0)
      excess = std::max(excess, moves[k].norm() / longest_step(objective, state, max_step, k));
  return excess;
}

}  // namespace dapple
