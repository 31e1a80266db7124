// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Exactly `count` points drawn with the surface's density (white noise). Each component of the
/// surface gets its share of them, by largest remainders: where cells follow the surface,
/// components exchange no sites.
[[nodiscard]] Sites random_start(const Surface& surface, std::size_t count, std::uint64_t seed);

/// Exactly `count` points by dart throwing: a dart is refused within r of an earlier one, r
/// following the density as phi^(-1/2), and r shrinks each time that too many darts in a row are
/// refused, until all fit. Components get their shares as above; darts of another component, or on
/// the far side of a wall, are not near.
/// \throw Cancelled
[[nodiscard]] Sites poisson_start(const Surface& surface, std::size_t count, std::uint64_t seed,
                                  Context* context = nullptr);

}  // namespace dapple
