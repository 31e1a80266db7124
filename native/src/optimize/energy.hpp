// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/energy.hpp>
#include <span>

namespace dapple {

/// The energy of the cells in `energy.diagram`, and its gradient.
/// \param capacity        of all cells together; that of the domain unless parts of it are left out
/// \param capacity_weight lambda >= 0
void sum_up(Energy& energy, double capacity, double capacity_weight);

/// The share of the capacity that belongs to cells: all but that of parts without any site, where
/// these are left. Normalized energies are of what is owned.
[[nodiscard]] double owned_share(const RestrictedVoronoi& diagram, double capacity);

/// A needle has hardly any area, but may be so long that squares of distances in it overflow.
/// \param energy  the sum over the cells
/// \param members indices of the cells' sites; empty if they are all of them
/// \throw SurfaceError naming the first site with such a cell
void check_finite_energy(double energy, const std::vector<Moments>& cells,
                         std::span<const std::int32_t> members = {});

}  // namespace dapple
