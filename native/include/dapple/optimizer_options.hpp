// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>

namespace dapple {

/// How a step is found.
enum class Method {
  kTrustRegion,  ///< L-BFGS preconditioned by the Gauss-Newton Hessian of the capacities, within a
                 ///< trust region
  kLineSearch,   ///< plain L-BFGS, as in the paper
};

/// What a deforming surface is to be brought back to, instead of minimizing on (trust region only).
///
/// Every step toward the minimum of E_cvt lowers it for good, and a long animation would turn blue
/// noise into hexagons, while deformation mostly disturbs the capacities. So what is minimized is
/// s E_cvt + lambda E_cap and the repulsion, where s follows how far E_cvt is above that of the
/// first frame: 0 while it is within a dead band.
struct Restoration {
  double cvt = std::numeric_limits<double>::infinity();  ///< n E_cvt / |S|_phi^2 of the first frame
  double dead_band = 7e-4;                               ///< above it, where s is 0
  double band = 1e-3;                                    ///< above that, where s rises to `share`
  double share = 0.3;  ///< the largest s, and the least delta of the trust region
  double variation =
      4.5e-3;  ///< capacity variation (standard deviation / mean) that is even enough
  double first_variation = 0.0;  ///< of the first frame: no frame has to be more even
  double alpha = 0.63;           ///< least distance along the surface, in local spacings
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
  std::optional<Restoration> restore = std::nullopt;                ///< minimize only so far
};

}  // namespace dapple
