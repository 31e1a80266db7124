// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/mirror.hpp"

#include "optimize/chosen_sites.hpp"

namespace dapple {
namespace {

constexpr double kParallel =
    1e-2;                  // sine of the angle between plane and face: no step to the plane
constexpr int kSteps = 3;  // to the plane, after a move along it

/// The part of a move along the plane and the surface: in the direction of their common line.
Vec3 along_both(const Vec3& move, const Vec3& plane, const Vec3& normal) {
  const Vec3 line = normal.cross(plane);
  const double squared = line.squaredNorm();
  if (squared < kParallel * kParallel) return move - plane.dot(move) * plane;
  return line.dot(move) / squared * line;
}

}  // namespace

Sites led_to_plane(const Domain& domain, const Mirror& mirror, Sites sites, int steps,
                   const Context* context) {
  for (int step = 0; step < steps; ++step) {
    for_each_vector(sites.size(), [&](std::size_t k) {
      const Vec3 normal = domain.normal(sites.faces[k]);
      const Vec3 uphill = mirror.normal - normal.dot(mirror.normal) * normal;
      const double squared = uphill.squaredNorm();
      if (squared > kParallel * kParallel)
        sites.positions[k] -= mirror.height(sites.positions[k]) / squared * uphill;
    });
    sites = domain.project(sites.positions, sites.faces, context);
  }
  return sites;
}

void Mirror::restrict(Vectors& moves, const Vectors& normals) const {
  for_each_vector(partners.size(), [&](std::size_t k) {
    const auto image = static_cast<std::size_t>(partners[k]);
    if (image == k) moves[k] = along_both(moves[k], normal, normals[k]);
    if (image <= k) return;
    moves[k] = 0.5 * (moves[k] + turned(moves[image]));
    moves[image] = turned(moves[k]);
  });
}

Sites Mirror::images(const Domain& domain, const Sites& sites, std::span<const std::int32_t> hints,
                     const Context* context) const {
  Vectors points = sites.positions;
  for (Vec3& place : points) place = reflected(place);
  Sites found = domain.project(points, hints, context);
  std::vector<std::int32_t> lost;  // a walk along an asymmetric surface may end elsewhere
  Vectors their_points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if ((found.positions[k] - points[k]).norm() <= farthest) continue;
    lost.push_back(static_cast<std::int32_t>(k));
    their_points.push_back(points[k]);
  }
  if (!lost.empty()) put(found, lost, domain.project(their_points, {}, context));
  return found;
}

Sites Mirror::project(const Domain& domain, const Vectors& points,
                      std::span<const std::int32_t> hints, const Context* context) const {
  Sites moved{points, {hints.begin(), hints.end()}, Vectors(points.size())};
  std::vector<std::int32_t> first, second, middle;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto image = static_cast<std::size_t>(partners[k]);
    if (image < k) continue;
    (image == k ? middle : first).push_back(static_cast<std::int32_t>(k));
    if (image > k) second.push_back(partners[k]);
    moved.positions[k] = 0.5 * (points[k] + reflected(points[image]));
  }
  const Sites from = select(moved, first);
  const Sites ahead = domain.project(from.positions, from.faces, context);
  put(moved, first, ahead);
  put(moved, second, images(domain, ahead, select(moved, second).faces, context));
  put(moved, middle, led_to_plane(domain, *this, select(moved, middle), kSteps, context));
  return moved;
}

}  // namespace dapple
