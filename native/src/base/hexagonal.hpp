// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <numbers>

namespace dapple {

/// Distance between neighbors of a hexagonal lattice that has `area` for each site.
inline double hexagonal_spacing(double area) { return std::sqrt(2.0 * area / std::numbers::sqrt3); }

}  // namespace dapple
