// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// Barycentric coordinates (>= 0, sum 1) of the point of triangle a, b, c closest to p; the
/// triangle may be degenerate.
[[nodiscard]] Vec3 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace dapple
