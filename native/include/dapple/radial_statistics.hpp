// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace dapple {

/// What a quantity over the plane is like at each distance from the origin.
struct RadialStatistics {
  std::vector<double> radius;      ///< middle of each annulus
  std::vector<double> mean;        ///< over the annulus
  std::vector<double> anisotropy;  ///< variance / mean^2 over the annulus, in decibels; -infinity
                                   ///< where nothing varies
};

}  // namespace dapple
