// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/types.hpp>

namespace dapple {

/// The weighted sum of the corners' values.
inline Vec3 combined(const std::array<Vec3, 3>& corners, const Vec3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// The point of the segment from a to b that is this share of the way from a.
inline Vec3 between(const Vec3& a, const Vec3& b, double share) {
  return (1.0 - share) * a + share * b;
}

/// Barycentric coordinates (>= 0, sum 1) of the point of triangle a, b, c closest to p; the
/// triangle may be degenerate.
[[nodiscard]] Vec3 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace dapple
