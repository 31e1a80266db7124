// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Exactly `count` points drawn with the surface's density (white noise). Each component of the
/// surface gets its share, by largest remainders, because components exchange no sites where cells
/// follow the surface.
[[nodiscard]] Sites random_start(const Surface& surface, std::size_t count, std::uint64_t seed);

/// Exactly `count` points by dart throwing: a dart is rejected within r of an earlier one, where r
/// follows the density as phi^(-1/2) and shrinks each time that too many darts in a row are
/// rejected, until all fit. Components get their shares as above; darts of another component, or on
/// the far side of a wall, do not reject each other.
/// \throw Cancelled
[[nodiscard]] Sites poisson_start(const Surface& surface, std::size_t count, std::uint64_t seed,
                                  Context* context = nullptr);

}  // namespace dapple
