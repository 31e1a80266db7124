// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_integrals.hpp"

#include <algorithm>
#include <limits>

#include "base/segment.hpp"
#include "surface/integrate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// From a point near it: the differences are exact, where the centroid itself is rounded to the
/// digits that coordinates have far from the origin.
Vec3 centroid_of(const Surface& surface, OrderedFace face, const Vec3& from) {
  const auto [a, b, c] = surface.ordered().corners(face);
  return ((surface.ordered().vertex(a) - from) + (surface.ordered().vertex(b) - from) +
          (surface.ordered().vertex(c) - from)) /
         3.0;
}

}  // namespace

void CellIntegrals::reset() {
  moments_ = Moments();
  boundary_.clear();
}

void CellIntegrals::add(OrderedFace face, bool whole) {
  const FaceGeometry& geometry = surface_->ordered().geometry(face);
  if (geometry.moments.area <= 0.0) return;
  const Vec3 centroid = geometry.centroid - flood_->position();
  if (whole) {
    add_shifted(moments_, geometry.moments, centroid);
    return;
  }
  set_density(geometry, centroid_of(*surface_, face, flood_->position()));
  add_area(geometry);
  add_boundary(geometry);
}

void CellIntegrals::flush_boundary(const OrderedSites& sites, std::vector<CellBoundary>& out) {
  for (std::size_t k = 0; k < boundary_.size(); ++k) {
    if (boundary_[k].length <= 0.0) continue;
    const Bisector& bisector = flood_->bisector(static_cast<std::int32_t>(k));
    const std::int32_t j = sites.original(bisector.site);
    const auto known = std::find_if(out.begin(), out.end(), [&](const CellBoundary& side) {
      return side.neighbor == j && side.offset == bisector.normal;
    });
    if (known == out.end()) {
      out.push_back(
          {j, boundary_[k].flux, bisector.normal, boundary_[k].length, boundary_[k].path_length});
    } else {
      known->flux += boundary_[k].flux;
      known->length += boundary_[k].length;
      known->path_length = std::min(known->path_length, boundary_[k].path_length);
    }
  }
  boundary_.clear();
}

void CellIntegrals::set_density(const FaceGeometry& geometry, const Vec3& centroid) {
  gradient_ = geometry.density_gradient;
  at_site_ = geometry.moments.capacity / geometry.moments.area - gradient_.dot(centroid);
}

void CellIntegrals::add_area(const FaceGeometry& geometry) {
  const auto corners = flood_->polygon().corners();
  const Vec3& a = corners[0].x;
  Moments piece;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vec3& b = corners[k - 1].x;
    const Vec3& c = corners[k].x;
    const double area = 0.5 * geometry.normal.dot((b - a).cross(c - a));
    if (uniform_)
      add_uniform_triangle(piece, area, a, b, c);
    else
      add_linear_triangle(piece, area, a, b, c, density(a), density(b), density(c));
  }
  if (uniform_) finish_uniform(piece);
  add_shifted(moments_, piece, Vec3::Zero());
}

// Both sites are as far from the points of a bisector, so the way over one is twice its distance.
// Along a bisector phi (x - x_i) has degree 2: Simpson's rule is exact.
void CellIntegrals::add_boundary(const FaceGeometry& geometry) {
  const auto corners = flood_->polygon().corners();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (corners[k].edge < 0) continue;
    const Vec3& p = corners[k].x;
    const Vec3& q = corners[k + 1 < corners.size() ? k + 1 : 0].x;
    const Vec3& d = flood_->bisector(corners[k].edge).normal;
    const double in_plane = (d - d.dot(geometry.normal) * geometry.normal).norm();
    const double length = (q - p).norm();
    if (in_plane <= 0.0 || length <= 0.0) continue;
    const Vec3 middle = 0.5 * (p + q);
    CellBoundary& sum = boundary_with(corners[k].edge);
    sum.length += length;
    sum.path_length = std::min(sum.path_length, 2.0 * distance_to_segment(p, q));
    sum.flux += length / (6.0 * in_plane) *
                (density(p) * p + 4.0 * density(middle) * middle + density(q) * q);
  }
}

CellBoundary& CellIntegrals::boundary_with(std::int32_t bisector) {
  const auto k = static_cast<std::size_t>(bisector);
  if (k >= boundary_.size())
    boundary_.resize(
        k + 1, {-1, Vec3::Zero(), Vec3::Zero(), 0.0, std::numeric_limits<double>::infinity()});
  return boundary_[k];
}

}  // namespace dapple
