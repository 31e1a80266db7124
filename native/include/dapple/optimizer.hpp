// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/energy.hpp>
#include <dapple/option.hpp>
#include <limits>
#include <tuple>

namespace dapple {

/// How steps are computed.
enum class Method {
  kTrustRegion,  ///< L-BFGS preconditioned by the Gauss-Newton Hessian of the capacities, within a
                 ///< trust region
  kLineSearch,   ///< plain L-BFGS, as in the paper
};

struct OptimizerOptions {
  /// Lambda, the weight of equal capacities: larger values look less like a lattice. 20 to 100 are
  /// useful for samples, less than 1 for the vertices of meshes.
  double capacity_weight = 30.0;  // basic, >= 0
  /// Kappa, the weight of the repulsion that keeps neighbors apart; 0 is the paper's plain energy.
  double repulsion_weight = 3.0;  // basic, >= 0
  /// Distance below which sites repel each other.
  double repulsion_radius = 0.72;  // internal, >= 0, local spacings
  /// Relative decrease of the energy at which to stop: smaller values are more regular and slower.
  double tolerance = 5e-5;  // basic, >= 0
  /// Steps in a row that decrease the energy by no more than the tolerance before it stops: one
  /// small step alone is no convergence.
  int patience = 2;  // internal, >= 1
  /// Maximum number of evaluations of the energy; for motions, in each frame or part of a frame.
  int max_evaluations = 200;  // basic, >= 1
  /// Steps that L-BFGS remembers.
  int history = 7;  // internal, >= 0
  /// Longest move of a site in one step.
  double max_step = 0.5;  // internal, >= 0, local spacings
  // Farther than the local spacing of the surface none goes either.
  /// Largest distance that a sample may slide from the position to which the surface carries it in
  /// a frame; after a violent frame, evenness is restored over the next ones.
  double max_slide = kInfinite;  // expert, 0..kInfinite, local spacings
  // sum m_k |x_k - start_k|^2, where m_k is the cell's integral of phi^2 at the start
  /// Gamma, the weight that holds a sample where the surface carries it: larger values slide less
  /// and are less even; 1 is the weight of E_cvt.
  double stickiness = 0.0;  // basic, >= 0
  // sum (m_i + m_j) / 2 |d_i - d_j|^2 over neighbors, where d_k = x_k - start_k
  /// Sigma, the weight that lets neighbors slide alike: larger values are calmer from frame to
  /// frame and less even; 1 is the weight of E_cvt.
  double slide_smoothing = 0.0;  // expert, >= 0
  /// Stop once the normalized energy is not above it.
  double target_energy = -kInfinite;  // internal, -kInfinite..kInfinite
  /// Method of finding a step: a trust region, or plain L-BFGS with a line search as in the paper.
  Method method = Method::kTrustRegion;  // expert
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const OptimizerOptions& options);

struct OptimizerResult {
  Sites sites;    ///< with barycentric coordinates
  Energy energy;  ///< at the sites
  std::vector<double>
      energies;  ///< the objective, normalized, at the start and after each iteration
  int evaluations = 0;
  int iterations = 0;
  /// Whether the minimization ended by one of its criteria; false if the evaluations ran out first,
  /// or if no step gained what the model promised.
  bool converged = false;
};

/// Minimize the energy over sites in a domain by the tangential gradient, with projection after
/// each step (paper, Algorithm 2) and Armijo backtracking. The objective never rises from one
/// iteration to the next.
///
/// The trust region: H0 = 2 delta diag(m) + 2 lambda J^T J + the repulsion's part; while the
/// longest step is too long, delta grows and the linear system is solved again, which costs no
/// evaluation. On thin and concave parts the Gauss-Newton step would carry sites far along the
/// surface; shortening the moves of single sites instead would spoil the step.
/// \param start with barycentric coordinates; without them it is projected first
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] OptimizerResult optimize(const Domain& domain, const Sites& start,
                                       const OptimizerOptions& options, Context* context = nullptr);

}  // namespace dapple
