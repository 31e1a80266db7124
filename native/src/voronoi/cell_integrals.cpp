// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_integrals.hpp"

#include <algorithm>
#include <cmath>

#include "base/segment.hpp"
#include "base/triple.hpp"
#include "surface/integrate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// The centroid relative to a nearby point, so that differences are exact; far from the origin the
/// centroid itself would be rounded.
Triple centroid_of(const Surface& surface, OrderedFace face, const Triple& from) {
  const auto [a, b, c] = surface.ordered().corners(face);
  const Triple sum = (Triple(surface.ordered().vertex(a)) - from) +
                     (Triple(surface.ordered().vertex(b)) - from) +
                     (Triple(surface.ordered().vertex(c)) - from);
  return {sum.x / 3.0, sum.y / 3.0, sum.z / 3.0};
}

}  // namespace

void CellIntegrals::reset() {
  moments_ = Moments();
  boundary_.clear();
}

void CellIntegrals::add(OrderedFace face, bool whole) {
  const FaceGeometry& geometry = surface_->ordered().geometry(face);
  if (geometry.moments.area <= 0.0) return;
  if (whole) {
    add_shifted(moments_, geometry.moments, Triple(geometry.centroid) - Triple(flood_->position()));
    return;
  }
  if (!uniform_) set_density(geometry, centroid_of(*surface_, face, Triple(flood_->position())));
  add_area(geometry);
  add_boundary(geometry);
}

void CellIntegrals::flush_boundary(const OrderedSites& sites, std::vector<CellBoundary>& out) {
  for (std::size_t k = 0; k < boundary_.size(); ++k) {
    const CellBoundary& part = boundary_[k];
    if (part.length <= 0.0) continue;
    const double path_length = 2.0 * std::sqrt(part.path_length);
    const Bisector& bisector = flood_->bisector(static_cast<std::int32_t>(k));
    const std::int32_t j = sites.original(bisector.site);
    const auto known = std::find_if(out.begin(), out.end(), [&](const CellBoundary& side) {
      return side.neighbor == j && side.offset == bisector.normal;
    });
    if (known == out.end()) {
      out.push_back({j, part.flux, bisector.normal, part.length, path_length});
    } else {
      known->flux += part.flux;
      known->length += part.length;
      known->path_length = std::min(known->path_length, path_length);
    }
  }
  boundary_.clear();
}

void CellIntegrals::set_density(const FaceGeometry& geometry, const Triple& centroid) {
  gradient_ = Triple(geometry.density_gradient);
  at_site_ = geometry.moments.capacity / geometry.moments.area - gradient_.dot(centroid);
}

void CellIntegrals::add_area(const FaceGeometry& geometry) {
  const auto corners = flood_->polygon().corners();
  const Triple normal(geometry.normal), a(corners[0].x);
  Integrals piece;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Triple b(corners[k - 1].x), c(corners[k].x);
    const double area = 0.5 * normal.dot((b - a).cross(c - a));
    if (uniform_)
      add_uniform_triangle(piece, area, a, b, c);
    else
      add_linear_triangle(piece, area, a, b, c, density(a), density(b), density(c));
  }
  if (uniform_) finish_uniform(piece);
  add_integrals(moments_, piece);
}

// Points of a bisector have equal distance from both sites, so a path through such a point has
// twice that length. Along a bisector phi (x - x_i) has degree 2: Simpson's rule is exact.
void CellIntegrals::add_boundary(const FaceGeometry& geometry) {
  const auto corners = flood_->polygon().corners();
  const Triple normal(geometry.normal);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (corners[k].edge < 0) continue;
    const Triple p(corners[k].x), q(corners[k + 1 < corners.size() ? k + 1 : 0].x);
    const Triple d(flood_->bisector(corners[k].edge).normal);
    const double in_plane = (d - d.dot(normal) * normal).norm();
    const Triple along = q - p;
    const double length = along.norm();
    if (in_plane <= 0.0 || length <= 0.0) continue;
    const Triple middle = 0.5 * (p + q);
    CellBoundary& sum = boundary_with(corners[k].edge);
    sum.length += length;
    sum.path_length = std::min(sum.path_length, squared_distance_to_segment(p, along));
    const Triple flux = uniform_ ? p + 4.0 * middle + q
                                 : density(p) * p + 4.0 * density(middle) * middle + density(q) * q;
    (length / (6.0 * in_plane) * flux).add_to(sum.flux);
  }
}

}  // namespace dapple
