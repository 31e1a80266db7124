// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// Measures of evenness of a set of sites. Neighbors are sites whose cells touch.
struct Evenness {
  double alpha_min = 0.0;   ///< normalized Poisson-disk radius: smallest ratio of nearest-neighbor
                            ///< distance to local hexagonal spacing
  double alpha_mean = 0.0;  ///< mean of this ratio over the sites
  double capacity_variation = 0.0;  ///< standard deviation / mean of the capacities
  /// Share of the sites on parts thinner than the spacing, such as wires. Their neighbors lie only
  /// ahead and behind, so no hexagonal spacing applies, and alpha leaves them out.
  double thin_share = 0.0;
};

/// Measure the evenness. The local spacing at a site is sqrt(2 a / sqrt(3)), where a is the area
/// that the mean capacity takes at the cell's own density, averaged with the density as weight (so
/// parts of the cell without density do not count as room); with constant density that is
/// Surface::spacing. Distances run along the surface, through the cells' common boundary.
/// \return all 0 for a diagram without cells; alpha is 0 if all sites are on thin parts
[[nodiscard]] Evenness measure_evenness(const RestrictedVoronoi& diagram);

/// Per site, whether its cell touches a border edge of the surface. The walk along the border goes
/// from cell to cell, starting at the nearest site of the edge's component, so no cell is clipped
/// again.
/// \pre the diagram was computed from these sites on this surface
/// \throw ArgumentError if the sites do not lie on the surface or their number differs from that of
/// the cells
[[nodiscard]] std::vector<bool> cells_on_border(const Surface& surface, const Sites& sites,
                                                const RestrictedVoronoi& diagram);

/// Bond-orientational order psi6 (Halperin and Nelson 1978): the mean over the sites of |mean over
/// the neighbors of exp(6 i theta)|, where theta is the angle of the neighbor's direction in the
/// plane of the site's normal. About 0.36 for white noise, 0.42 for dart throwing, 1 for a
/// hexagonal lattice. Sites marked in `left_out` do not count (a border cuts their hexagon), nor do
/// sites with fewer than three neighbors; 0 if none counts.
/// \param normals  unit, per site
/// \param left_out per site, or empty
/// \throw ArgumentError if the lengths do not match the diagram
[[nodiscard]] double bond_order(const RestrictedVoronoi& diagram, std::span<const Vec3> normals,
                                const std::vector<bool>& left_out = {});

}  // namespace dapple
