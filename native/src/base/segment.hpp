// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/types.hpp>

namespace dapple {

/// Of the segment p q from the origin.
/// \pre the points are not the same
template <typename Point>
[[nodiscard]] double distance_to_segment(const Point& p, const Point& q) {
  const Point d = q - p;
  return (p + std::clamp(-p.dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

}  // namespace dapple
