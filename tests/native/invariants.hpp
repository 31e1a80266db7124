// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>

namespace dapple::test {

/// What holds for every result: each sample on its face, weights >= 0 that sum to 1, unit normals,
/// ids unique, arrays of one length, and cells that share out the whole surface and its whole
/// density.
/// \param rounding as for check_cells()
void check(const Surface& surface, const Samples& samples, double rounding = 0.0);

/// The part about cells: areas sum to the surface's (1e-10 relative), capacities to its mass.
/// \param rounding area that may be missing or too much beside, where faces are so thin that the
/// digits of their corners say no more
void check_cells(const Surface& surface, const Sites& sites, double rounding = 0.0);

/// Each site is at `face`, `weights`, to rounding.
void check_on_surface(const Surface& surface, const Sites& sites, const std::vector<Vec3>& weights);

/// The same bytes.
[[nodiscard]] bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b);
[[nodiscard]] bool same_bytes(const Samples& a, const Samples& b);

/// The sites of samples.
[[nodiscard]] Sites sites_of(const Samples& samples);

}  // namespace dapple::test
