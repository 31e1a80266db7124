// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/optimizer_options.hpp>

#include "optimize/objective.hpp"

namespace dapple {

/// Where a minimization ended.
struct Minimum {
  State state;
  std::vector<double> energies;  ///< see OptimizerResult
  int evaluations = 0;
  int iterations = 0;
  bool settled = false;    ///< nothing is gained by going on: converged, or no step is found
  bool converged = false;  ///< see OptimizerResult
};

/// About how many evaluations an optimization takes that begins at a Poisson-disk start.
[[nodiscard]] double expected_evaluations(const OptimizerOptions& options);

/// See optimize(); repulsions are the terms' own.
/// \param home where sites are held by max_slide and stickiness; none: at the start
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] Minimum minimize(const Objective& objective, const Sites& start,
                               const OptimizerOptions& options, Context* context,
                               const Sites* home = nullptr);

}  // namespace dapple
