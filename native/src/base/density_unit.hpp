// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace dapple {

/// The factor for densities of the mean `scale * mean` before integration: 1 unless they are so far
/// from 1 that sums of squared integrals could overflow or underflow. A power of two, so that no
/// digit changes.
inline double density_unit(double scale, double mean) {
  constexpr int kNear = 64, kFar = 1000;  // powers of two
  if (!(scale > 0.0 && mean > 0.0)) return 1.0;
  const int power = std::ilogb(scale) + std::ilogb(mean);
  return std::abs(power) <= kNear ? 1.0 : std::ldexp(1.0, -std::clamp(power, -kFar, kFar));
}

}  // namespace dapple
