// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/optimizer.hpp>
#include <functional>
#include <limits>

#include "optimize/objective.hpp"
#include "optimize/restoration.hpp"

namespace dapple {

/// Where a minimization ended.
struct Minimum {
  Evaluation state;
  std::vector<double> energies;  ///< see OptimizerResult
  int evaluations = 0;
  int iterations = 0;
  bool settled = false;    ///< no further decrease: converged, or no step was found
  bool converged = false;  ///< see OptimizerResult
  bool paused = false;     ///< see Aim::pauses

  /// Count the work of another minimization too.
  void count(const Minimum& other) {
    evaluations += other.evaluations;
    iterations += other.iterations;
  }
};

/// Data of a frame of a deforming surface.
struct Tracked {
  /// Where sites are held by max_slide and stickiness; null: at the start.
  const Sites* home = nullptr;
  /// To end there, instead of minimizing on (trust region only); null: minimize.
  const Restoration* restoration = nullptr;
};

/// Criteria beside the target energy.
struct Aim {
  double variation = std::numeric_limits<double>::infinity();  ///< of the capacities, at most
  /// Asked after each step, with its relative decrease: whether to end before the minimum. Empty:
  /// never.
  std::function<bool(const Evaluation& state, double decrease)> pauses = {};
};

/// See optimize(); repulsions are the terms' own.
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] Minimum minimize(const Objective& objective, const Sites& start,
                               const OptimizerOptions& options, Context* context,
                               const Tracked& tracked = {}, const Aim& aim = {});

}  // namespace dapple
