// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <dapple/surface.hpp>

namespace dapple {

/// How many samples have this distance between neighbors if they are packed hexagonally, where the
/// density is largest: 2 M / (sqrt(3) spacing^2) to the nearest, at least 1. M is the mass over the
/// largest density, so the area if there is one density everywhere; then this is the inverse of
/// Surface::spacing().
/// \throw ArgumentError if the spacing is not finite and > 0, or for more than kMostSamples
[[nodiscard]] std::size_t count_at_spacing(const Surface& surface, double spacing);

}  // namespace dapple
