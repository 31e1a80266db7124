// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// The restricted Voronoi diagram with the integrals of the density times Surface::density_unit().
[[nodiscard]] RestrictedVoronoi unit_voronoi(const Surface& surface, const Sites& sites,
                                             Context* context, Cells cells);

/// Convert to the density's own unit.
void remove_unit(RestrictedVoronoi& diagram, double density_unit);

}  // namespace dapple
