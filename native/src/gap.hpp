// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "vectors.hpp"

namespace dapple {

/// Two sites nearer than they should be.
struct ClosePair {
  std::int32_t i, j;
  double stiffness;  ///< of the Gauss-Newton part along `direction`
  Vec3 direction;    ///< unit, from j to i
};

/// The soft gap: E_gap = kappa (|S|_phi / n)^2 sum over pairs of (1 - |x_i - x_j| / r_ij)^2 for
/// pairs nearer than r_ij whose cells touch. It adds what capacities alone do not give, a smallest
/// distance.
struct Gap {
  double energy = 0.0;
  Vectors gradient;
  std::vector<ClosePair> pairs;
};

/// \param radii  r_i per site; r_ij is the mean of the two
/// \param weight kappa (|S|_phi / n)^2
[[nodiscard]] Gap evaluate_gap(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                               double weight);

}  // namespace dapple
