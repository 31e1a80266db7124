// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <vector>

namespace dapple {

using Chosen = std::vector<std::size_t>;  ///< sites, in ascending order

/// Put chosen sites in order, each once.
void make_unique(Chosen& sites);

/// The chosen sites and so many rings of neighbors around them.
[[nodiscard]] Chosen with_rings(const RestrictedVoronoi& diagram, const Chosen& sites, int rings);

/// The same: per site, whether it is among them.
[[nodiscard]] std::vector<bool> around(const RestrictedVoronoi& diagram, const Chosen& sites,
                                       int rings);

/// The chosen sites in groups whose surroundings do not touch.
[[nodiscard]] std::vector<Chosen> places_of(const RestrictedVoronoi& diagram, const Chosen& sites,
                                            int rings);

}  // namespace dapple
