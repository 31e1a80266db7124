// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// How even a set of sites is. Neighbours are sites whose cells touch.
struct Evenness {
  double alpha_min =
      0.0;  ///< normalised Poisson-disk radius: nearest neighbour / local hexagonal spacing
  double alpha_mean = 0.0;       ///< the same ratio, averaged over the sites
  double capacity_spread = 0.0;  ///< standard deviation / mean of the capacities
};

/// Measure the evenness. The local spacing at a site is sqrt(2 a / sqrt(3)), where a is the area
/// that the mean capacity would take at the cell's own mean density; with constant density that is
/// Surface::spacing.
[[nodiscard]] Evenness measure_evenness(const RestrictedVoronoi& diagram);

}  // namespace dapple
