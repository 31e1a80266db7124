// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "gap.hpp"

namespace dapple {

/// The model Hessian H = 2 delta diag(m) + 2 lambda J^T J + the gap's part, on the tangent planes.
/// J is the Jacobian of the capacities: J_ii = sum_j a_ij, J_ji = -a_ij, with a_ij the boundary
/// fluxes. The first term is Lloyd's step scaled by delta, which a trust region raises to shorten
/// the step.
class GaussNewton {
 public:
  /// The arguments must outlive the operator.
  GaussNewton(const RestrictedVoronoi& diagram, const Gap& gap, const Vectors& normals,
              double capacity_weight);

  /// Solve H x = b approximately by conjugate gradients with a block-Jacobi preconditioner; b
  /// tangential.
  [[nodiscard]] Vectors solve(const Vectors& b, double delta) const;

 private:
  struct Inflow {
    std::int32_t from;  // j
    Vec3 flux;          // a_ji
  };

  void transpose();
  [[nodiscard]] Vectors apply(const Vectors& v, double delta) const;
  [[nodiscard]] std::vector<Eigen::Matrix3d> preconditioner(double delta) const;

  const RestrictedVoronoi& diagram_;
  const Gap& gap_;
  const Vectors& normals_;
  double capacity_weight_;
  double least_mass_;                // keeps empty cells from making H singular
  Vectors own_;                      // J_ii
  std::vector<std::size_t> starts_;  // rows of inflows_, one more than sites
  std::vector<Inflow> inflows_;
};

}  // namespace dapple
