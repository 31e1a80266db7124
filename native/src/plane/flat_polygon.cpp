// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/flat_polygon.hpp"

#include <algorithm>

namespace dapple {

bool FlatPolygon::cut(const Vec2& normal, double offset, std::int32_t label) {
  const auto beyond = [&](const Corner& corner) { return normal.dot(corner.x) - offset; };
  if (std::none_of(corners.begin(), corners.end(),
                   [&](const Corner& c) { return beyond(c) > 0.0; }))
    return false;
  kept_.clear();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Corner& a = corners[k];
    const Corner& b = corners[k + 1 < corners.size() ? k + 1 : 0];
    const double beyond_a = beyond(a);
    const double beyond_b = beyond(b);
    if (beyond_a <= 0.0) kept_.push_back(a);
    if ((beyond_a <= 0.0) == (beyond_b <= 0.0)) continue;
    const Vec2 x = a.x + beyond_a / (beyond_a - beyond_b) * (b.x - a.x);
    kept_.push_back({x, beyond_a <= 0.0 ? label : a.edge});
  }
  corners.swap(kept_);
  return true;
}

double FlatPolygon::squared_radius() const {
  double most = 0.0;
  for (const Corner& corner : corners) most = std::max(most, corner.x.squaredNorm());
  return most;
}

}  // namespace dapple
