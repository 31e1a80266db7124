// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/energy.hpp>
#include <dapple/optimizer_options.hpp>

namespace dapple {

struct OptimizerResult {
  Sites sites;    ///< with barycentric coordinates
  Energy energy;  ///< at the sites
  std::vector<double>
      energies;  ///< what was minimized, normalized, at the start and after each iteration
  int evaluations = 0;
  int iterations = 0;
  /// Whether the energy, its decreases or the restoration met what ends the minimization; false if
  /// the evaluations ran out first, or if steps that promised more were not found.
  bool converged = false;
};

/// Minimize the energy over sites in a domain, on the tangential gradient, with projection after
/// each step (paper, Algorithm 2) and Armijo backtracking. What is minimized never rises from one
/// iteration to the next.
///
/// The trust region: H0 = 2 delta diag(m) + 2 lambda J^T J + the repulsion's part; while the
/// longest step is too long, delta grows and the linear system is solved again, which costs no
/// evaluation. On thin and concave parts the Gauss-Newton step wants to carry sites far along the
/// surface; shortening the sites one by one instead would break it.
/// \param start with barycentric coordinates; without them it is projected first
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] OptimizerResult optimize(const Domain& domain, const Sites& start,
                                       const OptimizerOptions& options, Context* context = nullptr);

}  // namespace dapple
