// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Poisson-disk points on the unit torus: as poisson_start, with distances around the torus.
/// \param period a flat surface that covers the torus once \throw Cancelled
[[nodiscard]] std::vector<Vec3> periodic_poisson_start(const Surface& period, std::size_t count,
                                                       std::uint64_t seed, const Context* context);

}  // namespace dapple
