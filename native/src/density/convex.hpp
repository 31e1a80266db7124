// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Whether the convex hulls of two sets of points, both not empty, are farther apart than a
/// distance. True is certain: a plane with this distance to one hull separates them. False is also
/// returned where rounding leaves it open.
[[nodiscard]] bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, double distance);

}  // namespace dapple
