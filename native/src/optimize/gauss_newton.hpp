// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/objective.hpp"

namespace dapple {

/// One term's part of the model Hessian: scale (2 delta diag(m) + 2 lambda J^T J + the repulsion's
/// part). J is the Jacobian of the capacities: J_ii = sum_j a_ij, J_ji = -a_ij, with a_ij the
/// boundary fluxes.
class GaussNewtonPart {
 public:
  /// The arguments must outlive the part.
  /// \param members as in Term
  GaussNewtonPart(const Part& part, const std::vector<std::int32_t>& members,
                  double capacity_weight, double scale);

  /// Add the product with v to `result`; both hold all sites.
  void add_product(const Vectors& v, double delta, Vectors& result) const;

  /// Add the diagonal blocks.
  void add_blocks(double delta, std::vector<Eigen::Matrix3d>& blocks) const;

 private:
  struct Inflow {
    std::int32_t from;  // j
    Vec3 flux;          // a_ji
  };

  void transpose();
  [[nodiscard]] std::size_t site(std::size_t member) const;
  [[nodiscard]] Vectors product(const Vectors& v, double delta) const;

  const Part& part_;
  const RestrictedVoronoi& diagram_;
  const std::vector<std::int32_t>& members_;
  double capacity_weight_;
  double scale_;
  double least_mass_;                // keeps empty cells from making H singular
  Vectors own_;                      // J_ii
  std::vector<std::size_t> starts_;  // rows of inflows_, one more than sites
  std::vector<Inflow> inflows_;
};

/// The model Hessian of an objective on the tangent planes, locked sites left out. Its first term
/// is Lloyd's step scaled by delta, which a trust region raises to shorten the step.
class GaussNewton {
 public:
  /// The arguments must outlive the operator.
  /// \param steps of conjugate gradients, at most
  /// \param context is asked at each whether to go on, no more
  GaussNewton(const Objective& objective, const State& state, int steps,
              const Context* context = nullptr);

  /// Solve H x = b approximately by conjugate gradients with a block-Jacobi preconditioner; b
  /// restricted.
  /// \throw Cancelled
  [[nodiscard]] Vectors solve(const Vectors& b, double delta) const;

 private:
  [[nodiscard]] Vectors apply(const Vectors& v, double delta) const;
  [[nodiscard]] std::vector<Eigen::Matrix3d> preconditioner(double delta) const;

  const Objective& objective_;
  const State& state_;
  int steps_;
  const Context* context_;
  std::vector<GaussNewtonPart> parts_;
};

}  // namespace dapple
