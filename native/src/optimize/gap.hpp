// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "base/vectors.hpp"

namespace dapple {

/// Two sites nearer than they should be.
struct ClosePair {
  std::int32_t i, j;
  double lack;       ///< 1 - distance / r_ij
  double energy;     ///< what the pair adds to the gap's
  double stiffness;  ///< of the Gauss-Newton part along `direction`
  Vec3 direction;    ///< unit, from j to i
};

/// The soft gap: E_gap = weight * sum over pairs of (1 - |x_i - x_j| / r_ij)^2 for pairs nearer
/// than r_ij. It adds what capacities alone do not give, a smallest distance.
struct Gap {
  double energy = 0.0;
  Vectors gradient;
  std::vector<ClosePair> pairs;
};

/// The gap between sites whose cells touch.
/// \param radii  r_i per site; r_ij is the mean of the two; empty for no gap
/// \param weight kappa (|S|_phi / n)^2
[[nodiscard]] Gap evaluate_gap(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                               double weight);

/// Halve the moves of touching sites that would bring two of them nearer than the gap wants and
/// than they are: of such pairs, farther apart than r_ij so far, neither the gap's gradient nor its
/// stiffness knows.
/// \return how many sites that were
std::size_t shorten_approaches(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                               Vectors& moves);

/// The gap between things: r_ij is the sum of their radii, and all count that are on the same side
/// of a wall, whether their cells touch or not.
/// \param normals of the surface, per site
/// \param period  of the torus; 0 elsewhere
[[nodiscard]] Gap evaluate_things(const Sites& sites, const Vectors& normals,
                                  const std::vector<double>& radii, double period, double weight);

/// The closest of the pairs; null if there is none.
[[nodiscard]] const ClosePair* worst_pair(const Gap& gap);

}  // namespace dapple
