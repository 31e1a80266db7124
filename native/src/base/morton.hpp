// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Indices of the points along a Morton (Z-order) curve through their bounding box, ties by index:
/// points near in space come near in memory, which halves the time of the restricted Voronoi
/// diagram.
[[nodiscard]] std::vector<std::int32_t> morton_order(std::span<const Vec3> points,
                                                     Context* context = nullptr);

}  // namespace dapple
