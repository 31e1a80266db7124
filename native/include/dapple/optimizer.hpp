// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/energy.hpp>
#include <dapple/projector.hpp>
#include <limits>

namespace dapple {

struct OptimizerOptions {
  double capacity_weight = 30.0;  ///< lambda
  double tolerance = 1e-5;        ///< stop when the energy's relative decrease is not above it ...
  int patience = 2;               ///< ... this many times in a row: one small step alone is no convergence
  int max_evaluations = 200;      ///< of the energy; at least 1
  int memory = 7;                 ///< L-BFGS pairs
  double max_step = 0.5;          ///< longest move of a site in one step, in spacings
  double target_energy = -std::numeric_limits<double>::infinity();  ///< stop once the normalised energy is not above it
};

struct OptimizerResult {
  Sites sites;                   ///< with barycentric coordinates
  Energy energy;                 ///< at the sites
  std::vector<double> energies;  ///< normalised energy of the start and after each iteration
  int evaluations = 0;
  int iterations = 0;
  bool converged = false;  ///< false if the evaluations ran out first
};

/// Minimise the energy over sites on a surface: L-BFGS on the tangential gradient, projection after each step (paper,
/// Algorithm 2), with Armijo backtracking. The energy never rises from one iteration to the next.
/// \param start with barycentric coordinates; without them it is projected first
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] OptimizerResult optimize(const Surface& surface, const Projector& projector, const Sites& start,
                                       const OptimizerOptions& options, Context* context = nullptr);

}  // namespace dapple
