// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/restricted_voronoi.hpp>
#include <span>
#include <vector>

namespace dapple {

/// A needle has hardly any area, but may be so long that squares of distances in it overflow.
/// \param energy the sum over the cells
/// \param members indices of the cells' sites; empty if they are all of them
/// \throw SurfaceError naming the first site with such a cell
void check_finite_energy(double energy, const std::vector<Moments>& cells,
                         std::span<const std::int32_t> members = {});

}  // namespace dapple
