// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// The index of a cell, bounded from above; 0 for NaN, which results if all points coincide or
/// their distance overflows.
inline std::uint64_t cell_along(double along, double most) {
  return static_cast<std::uint64_t>(std::max(0.0, std::min(along, most)));
}

/// Indices of the points along a Morton (Z-order) curve through their bounding box, ties by index:
/// points near in space come near in memory, which halves the time of the restricted Voronoi
/// diagram.
[[nodiscard]] std::vector<std::int32_t> morton_order(std::span<const Vec3> points,
                                                     Context* context = nullptr);

}  // namespace dapple
