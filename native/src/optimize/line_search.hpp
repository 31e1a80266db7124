// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "optimize/lbfgs.hpp"
#include "optimize/objective.hpp"

namespace dapple {

/// A direction of plain L-BFGS, as in the paper; each site's move is cut to the longest step.
/// \param max_step in local spacings
[[nodiscard]] Vectors lbfgs_direction(const Objective& objective, const Evaluation& state,
                                      double max_step, LbfgsHistory& history);

/// How a line search continues after a step with too small a decrease.
struct Backtracking {
  int most = 6;  ///< steps tried
  /// Whether to hold back only the sites beside a jump of the energy, if those are few.
  bool holds_back = false;
  /// Whether to give up where the energy jumps: another direction is worth more than a shorter
  /// step.
  bool gives_up = false;
};

/// Where a line search ended.
struct Step {
  bool found = false;      ///< whether the state that was reached last lowers the energy enough
  double shortened = 1.0;  ///< factor of the step, for all sites
  double jump = 0.0;       ///< of the energy, for which it gave up
};

/// Armijo's rule: the longest of the shortened steps that lowers the energy by a share of what its
/// slope predicts.
/// \param at the state after moves, valid until the next call; null if no evaluation is left
[[nodiscard]] Step backtrack(const Objective& objective, const Evaluation& from, Vectors direction,
                             const Backtracking& how,
                             const std::function<const Evaluation*(const Vectors& moves)>& at);

}  // namespace dapple
