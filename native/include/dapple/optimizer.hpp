// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/energy.hpp>
#include <limits>

namespace dapple {

/// How a step is found.
enum class Method {
  kTrustRegion,  ///< L-BFGS preconditioned by the Gauss-Newton Hessian of the capacities, within a
                 ///< trust region
  kLineSearch,   ///< plain L-BFGS, as in the paper
};

struct OptimizerOptions {
  Method method = Method::kTrustRegion;
  double capacity_weight = 30.0;  ///< lambda >= 0
  double gap_weight = 3.0;   ///< kappa >= 0: keeps neighbours apart; 0 is the paper's plain energy
  double gap_radius = 0.72;  ///< distance below which the gap acts, in local spacings
  double tolerance = 5e-5;   ///< stop when the energy's relative decrease is not above it ...
  int patience = 2;  ///< ... this many times in a row: one small step alone is no convergence
  int max_evaluations = 200;  ///< of the energy; at least 1
  int memory = 7;             ///< L-BFGS pairs
  double max_step = 0.5;      ///< longest move of a site in one step, in local spacings
  double max_slide =
      std::numeric_limits<double>::infinity();  ///< farthest from the start, in local spacings
                                                ///< and in the surface's
  double target_energy = -std::numeric_limits<double>::infinity();  ///< stop once the normalised
                                                                    ///< energy is not above it
};

struct OptimizerResult {
  Sites sites;    ///< with barycentric coordinates
  Energy energy;  ///< at the sites
  std::vector<double>
      energies;  ///< what was minimised, normalised, at the start and after each iteration
  int evaluations = 0;
  int iterations = 0;
  bool converged = false;  ///< false if the evaluations ran out first
};

/// Minimise the energy over sites in a domain, on the tangential gradient, with projection after
/// each step (paper, Algorithm 2) and Armijo backtracking. What is minimised never rises from one
/// iteration to the next.
///
/// The trust region: H0 = 2 delta diag(m) + 2 lambda J^T J + the gap's part; while the longest step
/// is too long, delta grows and the linear system is solved again, which costs no evaluation. On
/// thin and concave parts the Gauss-Newton step wants to carry sites far along the surface;
/// shortening the sites one by one instead would break it. \param start with barycentric
/// coordinates; without them it is projected first \throw ArgumentError for options out of range;
/// Cancelled
[[nodiscard]] OptimizerResult optimize(const Domain& domain, const Sites& start,
                                       const OptimizerOptions& options, Context* context = nullptr);

}  // namespace dapple
