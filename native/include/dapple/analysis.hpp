// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// How even a set of sites is. Neighbors are sites whose cells touch.
struct Evenness {
  double alpha_min =
      0.0;  ///< normalized Poisson-disk radius: nearest neighbor / local hexagonal spacing
  double alpha_mean = 0.0;          ///< the same ratio, averaged over the sites
  double capacity_variation = 0.0;  ///< standard deviation / mean of the capacities
  /// Share of the sites on parts that are thinner than the spacing, such as wires: their neighbors
  /// are before and behind them only, so no hexagonal spacing fits, and alpha is without them.
  double thin_share = 0.0;
};

/// Measure the evenness. The local spacing at a site is sqrt(2 a / sqrt(3)), where a is the area
/// that the mean capacity would take at the cell's own density, averaged by itself (so a part of
/// the cell without density does not count as room); with constant density that is
/// Surface::spacing. Distances are along the surface, through the cells' common boundary.
/// \return all 0 for a diagram without cells; alpha 0 where all sites are on thin parts
[[nodiscard]] Evenness measure_evenness(const RestrictedVoronoi& diagram);

/// Per site whether its cell touches a border edge of the surface. The border edges are walked from
/// cell to cell, from the nearest site of the edge's component on, so no cell is cut anew.
/// \pre the diagram is of these sites on this surface
/// \throw ArgumentError if the sites are not of the surface or not as many as the cells
[[nodiscard]] std::vector<bool> cells_on_border(const Surface& surface, const Sites& sites,
                                                const RestrictedVoronoi& diagram);

/// Bond-orientational order psi6 (Halperin and Nelson 1978): the mean over the sites of
/// |mean over the neighbors of exp(6 i theta)|, where theta is the angle of the neighbor's
/// direction in the plane of the site's normal. About 0.36 for white noise, 0.42 for dart throwing,
/// 1 for a hexagonal lattice. Sites with an entry in `left_out` do not count (their hexagon is cut
/// by a border), nor do sites with fewer than three neighbors; 0 if none counts.
/// \param normals  unit, per site
/// \param left_out per site, or empty
/// \throw ArgumentError if the lengths do not fit the diagram
[[nodiscard]] double bond_order(const RestrictedVoronoi& diagram, std::span<const Vec3> normals,
                                const std::vector<bool>& left_out = {});

}  // namespace dapple
