// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <limits>

#include "base/hexagonal.hpp"
#include "base/triangle.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kAmple = 2.5;  // of the distance that half of a component's samples move: others
                                // need more, but up to half may have lost their surface
constexpr std::size_t kAround = 24;  // neighbors that are assumed to move alike
constexpr double kDamping = 0.1;     // weight of not moving, relative to the number of neighbors
constexpr double kFarthest =
    0.25;  // of a component's size: surfaces farther away belong to another component

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// \param values not empty
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void add(Transferred& found, std::size_t k, const Vec3& position, std::int32_t face,
         const Vec3& barycentric) {
  found.which.push_back(static_cast<std::int32_t>(k));
  found.sites.positions.push_back(position);
  found.sites.faces.push_back(face);
  found.sites.barycentric.push_back(barycentric);
}

}  // namespace

/// For each site, the nearest point of the next surface and whether that point is on the same side.
struct Transfer::Nearest {
  Projection places;
  std::vector<Vec3> normals;  // of the sites' faces, because interpolated normals tilt at edges
  std::vector<bool> same_side;
};

Transfer::Transfer(const Surface& before, const Surface& next, const Sites& samples,
                   const Reach& reach, const Context* context)
    : before_(before),
      next_(next),
      projector_(next, /*support_only=*/true, context),
      reach_(reach),
      motion_(at(before.ordered().components()), 0.0) {
  const Nearest near = nearest(samples, context);
  measure_motion(samples, near);
  const Sites there = moved(samples, near);
  samples_ = within_reach(there, nearest(there, context));
}

Transferred Transfer::find(const Sites& sites, const Context* context) const {
  const Sites there = moved(sites, nearest(sites, context));
  return within_reach(there, nearest(there, context));
}

/// The likely positions. The nearest points determine the motion along their normals, and neighbors
/// with other normals determine the rest. If all normals are alike, nothing determines the motion
/// along the surface, and the sites do not move along it.
Sites Transfer::moved(const Sites& sites, const Nearest& near) const {
  const Neighbors tree(sites.positions);
  std::vector<Neighbor> around;
  Sites result = sites;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    tree.nearest(sites.positions[k], kAround, around);
    std::erase_if(around, [&](const Neighbor& other) {
      return !is_found(sites, near, at(other.index)) ||
             component(sites.faces[at(other.index)]) != component(sites.faces[k]);
    });
    result.positions[k] += common_way(sites, near, around);
  }
  return result;
}

/// The translation that brings sites closest to the planes of their nearest points (least squares).
Vec3 Transfer::common_way(const Sites& sites, const Nearest& near,
                          std::span<const Neighbor> which) const {
  Eigen::Matrix3d planes = kDamping * static_cast<double>(kAround) * Eigen::Matrix3d::Identity();
  Vec3 sum = Vec3::Zero();
  for (const Neighbor& one : which) {
    const std::size_t k = at(one.index);
    const OrderedFace face = next_.ordered().ordered_face(near.places.faces[k]);
    const Vec3& normal = next_.ordered().geometry(face).normal;
    planes += normal * normal.transpose();
    sum += normal.dot(near.places.positions[k] - sites.positions[k]) * normal;
  }
  return planes.inverse() * sum;
}

Transfer::Nearest Transfer::nearest(const Sites& sites, const Context* context) const {
  Nearest near{projector_.project(sites.positions, {}, context), {}, {}};
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const OrderedFace face = before_.ordered().ordered_face(sites.faces[k]);
    near.normals.push_back(before_.ordered().geometry(face).normal);
    near.same_side.push_back(is_same_side(near.places.faces[k], near.normals[k]));
  }
  return near;
}

void Transfer::measure_motion(const Sites& samples, const Nearest& near) {
  std::vector<std::vector<double>> ways(motion_.size());
  std::vector<Eigen::AlignedBox3d> boxes(motion_.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t c = component(samples.faces[k]);
    boxes[c].extend(samples.positions[k]);
    if (near.same_side[k]) ways[c].push_back(near.places.distances[k]);
  }
  for (std::size_t c = 0; c < motion_.size(); ++c)
    if (!ways[c].empty())
      motion_[c] =
          std::min(kAmple * median(std::move(ways[c])), kFarthest * boxes[c].diagonal().norm());
}

Transferred Transfer::within_reach(const Sites& sites, const Nearest& near) const {
  std::vector<std::size_t> others;  // sites whose nearest point is on the other side of a sheet
  std::vector<Vec3> points;
  std::vector<double> radii;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const double reach = reach_of(sites, k);
    if (near.same_side[k] || near.places.distances[k] > reach || reach == 0.0) continue;
    others.push_back(k);
    points.push_back(sites.positions[k]);
    radii.push_back(reach);
  }
  const std::vector<std::vector<std::int32_t>> around = projector_.faces_within(points, radii);
  Transferred found;
  std::size_t other = 0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (is_found(sites, near, k))
      add(found, k, near.places.positions[k], near.places.faces[k], near.places.barycentric[k]);
    if (other == others.size() || others[other] != k) continue;
    add_nearest(found, k, sites.positions[k], near.normals[k], around[other++]);
  }
  return found;
}

bool Transfer::is_found(const Sites& sites, const Nearest& near, std::size_t k) const {
  return near.same_side[k] && near.places.distances[k] <= reach_of(sites, k);
}

/// Add the nearest point on faces of the same side, if there is one.
void Transfer::add_nearest(Transferred& found, std::size_t k, const Vec3& point, const Vec3& normal,
                           std::span<const std::int32_t> faces) const {
  double least = std::numeric_limits<double>::infinity();
  Sites best;
  for (const std::int32_t face : faces) {
    if (!is_same_side(face, normal)) continue;
    const auto [a, b, c] = next_.ordered().corners(next_.ordered().ordered_face(face));
    const Vec3 weights = closest_barycentric(point, next_.ordered().vertex(a),
                                             next_.ordered().vertex(b), next_.ordered().vertex(c));
    const Vec3 place = next_.point(face, weights);
    const double squared = (place - point).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    best = {{place}, {face}, {weights}};
  }
  if (best.size() > 0) add(found, k, best.positions[0], best.faces[0], best.barycentric[0]);
}

/// \return 0 where there is no density, because no sample may be there
double Transfer::reach_of(const Sites& sites, std::size_t k) const {
  const OrderedFace face = before_.ordered().ordered_face(sites.faces[k]);
  const double density = sites.barycentric[k].dot(before_.ordered().densities(face));
  const double spacing = density > 0.0 ? hexagonal_spacing(1.0 / (reach_.density * density)) : 0.0;
  return std::max(reach_.spacings * spacing, motion_[component(sites.faces[k])]);
}

std::size_t Transfer::component(std::int32_t face) const {
  return at(before_.ordered().component(before_.ordered().ordered_face(face)));
}

bool Transfer::is_same_side(std::int32_t face, const Vec3& normal) const {
  return next_.ordered().geometry(next_.ordered().ordered_face(face)).normal.dot(normal) > 0.0;
}

}  // namespace dapple
