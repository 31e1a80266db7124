// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>

namespace dapple {

/// E = E_cvt + lambda E_cap at given sites (paper, equation 6, with rho = phi^2), and its gradient.
struct Energy {
  double total = 0.0;
  double cvt = 0.0;            ///< sum of the integrals of phi^2 |x - x_i|^2
  double capacity_term = 0.0;  ///< sum of the squared capacities, without the weight
  double normalized = 0.0;     ///< e = n E / |S|_phi^2 - lambda, independent of n, size and units;
                               ///< 0.16037 for hexagons
  std::vector<Vec3> gradient;  ///< per site, in space (not yet tangential)
  RestrictedVoronoi diagram;
};

/// \param capacity_weight lambda >= 0; the paper finds 20..100 useful, 30 is its default
/// \throw ArgumentError if the sites are not finite, their faces out of range or lambda negative;
/// SurfaceError if vertices are so far apart that the energy is not finite; Cancelled
[[nodiscard]] Energy evaluate_energy(const Surface& surface, const Sites& sites,
                                     double capacity_weight, Cells cells = Cells::kConnected,
                                     Context* context = nullptr);

/// The same over any domain.
[[nodiscard]] Energy evaluate_energy(const Domain& domain, const Sites& sites,
                                     double capacity_weight, Context* context = nullptr);

/// The same in the memory of `energy`, whatever it held: repeated evaluations of as many sites on
/// one surface allocate only what grows. After an error its contents are unspecified.
void update_energy(Energy& energy, const Domain& domain, const Sites& sites, double capacity_weight,
                   Context* context = nullptr);

}  // namespace dapple
