// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>
#include <span>

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

/// Whether the density at a point of a face is above 0. A point where a face's density falls to
/// exactly 0, such as a corner, does not count: no sample may be there, but for a locked one.
[[nodiscard]] bool is_where_dense(const Surface& surface, std::int32_t face, const Vec3& weights);

/// No sample is where the density is 0, but for locked ones.
/// \param locked ids of those
void check_where_dense(const Surface& surface, const Samples& samples,
                       std::span<const std::int32_t> locked = {});

/// The same bytes.
[[nodiscard]] bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b);
[[nodiscard]] bool same_bytes(const Samples& a, const Samples& b);

/// The sites of samples.
[[nodiscard]] Sites sites_of(const Samples& samples);

}  // namespace dapple::test
