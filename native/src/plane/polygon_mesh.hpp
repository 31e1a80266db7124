// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>

namespace dapple {

using Ring = std::vector<Vec2>;

/// A flat surface of density 1 that fills the outline except for the holes.
/// \throw ArgumentError naming the first point that is not finite or repeats another, the first
/// edge that crosses or touches another, a ring of fewer than three points, a hole outside
[[nodiscard]] Surface polygon_surface(const Ring& outline, std::span<const Ring> holes);

}  // namespace dapple
