// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/domain.hpp>
#include <numbers>

#include "local_projection.hpp"
#include "validate.hpp"

namespace dapple {

double Domain::spacing(std::size_t count) const {
  const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
  return std::sqrt(2.0 * area() / (std::numbers::sqrt3 * n));
}

RestrictedVoronoi SurfaceDomain::cells(const Sites& sites, const Context* context) const {
  return restricted_voronoi(surface_, sites, context, cells_);
}

Sites SurfaceDomain::project(std::span<const Vec3> points,
                             std::span<const std::int32_t> hints) const {
  Projection found = projector_.project(points, hints);
  if (!hints.empty()) LocalProjection(surface_).mend(points, hints, found);
  return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
}

Vec3 SurfaceDomain::normal(std::int32_t face) const {
  return surface_.geometry(surface_.ordered_face(face)).normal;
}

void SurfaceDomain::check(const Sites& sites) const { check_sites(surface_, sites); }

}  // namespace dapple
