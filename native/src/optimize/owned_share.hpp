// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// What share of the capacity belongs to cells: all but that of parts without any site, where these
/// are left. Normalized energies are of what is owned.
[[nodiscard]] double owned_share(const RestrictedVoronoi& diagram, double capacity);

}  // namespace dapple
