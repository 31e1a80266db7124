// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>
#include <span>

namespace dapple::test {

/// Check the invariants of every result: each sample is on its face, weights are >= 0 and sum to 1,
/// normals have length 1, ids are unique, arrays have equal lengths, and cells cover the whole
/// surface and its whole density.
/// \param rounding as for check_cells()
void check(const Surface& surface, const Samples& samples, double rounding = 0.0);

/// Check the invariants of cells: areas sum to the surface's area (1e-10 relative), capacities to
/// the integral of its density.
/// \param rounding additional error of the area that is allowed, for faces so thin that the
/// rounding of their corners causes it
void check_cells(const Surface& surface, const Sites& sites, double rounding = 0.0);

/// Check that each site is at `face`, `weights`, up to rounding.
void check_on_surface(const Surface& surface, const Sites& sites, const std::vector<Vec3>& weights);

/// Whether the density at a point of a face is above 0. A point where a face's density is exactly
/// 0, such as a corner, does not count: only locked samples may be there.
[[nodiscard]] bool is_where_dense(const Surface& surface, std::int32_t face, const Vec3& weights);

/// Check that only locked samples are where the density is 0.
/// \param locked their ids
void check_where_dense(const Surface& surface, const Samples& samples,
                       std::span<const std::int32_t> locked = {});

/// Whether the vectors have the same bytes.
[[nodiscard]] bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b);
[[nodiscard]] bool same_bytes(const Samples& a, const Samples& b);

/// The sites of samples.
[[nodiscard]] Sites sites_of(const Samples& samples);

}  // namespace dapple::test
