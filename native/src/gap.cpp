// SPDX-License-Identifier: GPL-3.0-or-later
#include "gap.hpp"

namespace dapple {

Gap evaluate_gap(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                 double weight) {
  Gap gap;
  gap.gradient.assign(diagram.cells.size(), Vec3::Zero());
  if (weight == 0.0) return gap;
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    for (const CellBoundary& side : diagram.boundary(i)) {
      const auto j = static_cast<std::size_t>(side.neighbour);
      if (j < i) continue;  // each pair once: rounding aside, both cells list their common boundary
      const Vec3 d = -side.offset;
      const double distance = d.norm();
      const double radius = 0.5 * (radii[i] + radii[j]);
      if (distance >= radius || distance <= 0.0) continue;
      const double lack = 1.0 - distance / radius;
      const Vec3 direction = d / distance;
      const Vec3 force = 2.0 * weight * lack / radius * direction;
      gap.energy += weight * lack * lack;
      gap.gradient[i] -= force;
      gap.gradient[j] += force;
      gap.pairs.push_back({static_cast<std::int32_t>(i), side.neighbour,
                           2.0 * weight / (radius * radius), direction});
    }
  return gap;
}

}  // namespace dapple
