// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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
  double repulsion_weight =
      3.0;  ///< kappa >= 0: keeps neighbors apart; 0 is the paper's plain energy
  double repulsion_radius =
      0.72;                 ///< distance below which sites repel each other, in local spacings
  double tolerance = 5e-5;  ///< stop when the energy's relative decrease is not above it ...
  int patience = 2;  ///< ... this many times in a row: one small step alone is no convergence
  int max_evaluations = 200;  ///< of the energy; at least 1
  int history = 7;            ///< L-BFGS pairs
  double max_step = 0.5;      ///< longest move of a site in one step, in local spacings
  double max_slide =
      std::numeric_limits<double>::infinity();  ///< farthest from the start, in local spacings
                                                ///< and in the surface's
  double stickiness = 0.0;  ///< gamma >= 0: weight of sum m_k |x_k - start_k|^2, where m_k is the
                            ///< cell's integral of phi^2 at the start; 1 is that of E_cvt
  double target_energy = -std::numeric_limits<double>::infinity();  ///< stop once the normalized
                                                                    ///< energy is not above it
};

}  // namespace dapple
