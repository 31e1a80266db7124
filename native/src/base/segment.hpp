// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace dapple {

/// The t from 0 to 1 at which a + t * (b - a) is nearest to p; 0 if a and b are at one place.
template <typename Vector>
[[nodiscard]] double nearest_share(const Vector& p, const Vector& a, const Vector& b) {
  const Vector along = b - a;
  const double squared = along.dot(along);
  return squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
}

/// The squared distance of the segment from p to p + along from the origin.
/// \param p, along vectors of any kind that have dot()
/// \pre along is not 0
template <typename Vector>
[[nodiscard]] double squared_distance_to_segment(const Vector& p, const Vector& along) {
  const Vector nearest = p + std::clamp(-p.dot(along) / along.dot(along), 0.0, 1.0) * along;
  return nearest.dot(nearest);
}

}  // namespace dapple
