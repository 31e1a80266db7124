// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/sky.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/exposure.hpp>

#include "base/elementary.hpp"
#include "skin/crossings.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kParallel = 1.0 - 1e-6;  // cosine of the angle between faces on each other
constexpr std::size_t kStride = 35;       // coprime to the number of directions
// From within a hollow part that is open, every place sees a little of the sky. There a place must
// see this many times as much as elsewhere, up to this share.
constexpr double kInsideRatio = 4.0, kInsideMost = 0.2;
constexpr std::size_t kInnerRays = 8;  // rays from which inner_share() is estimated

/// Points of a Fibonacci lattice on the unit sphere, in an order in which the first few are spread
/// too: a place in the open is then known after few rays.
std::vector<Vec3> sky_directions() {
  constexpr auto kCount = static_cast<std::size_t>(kSkyDirections);
  const double golden = 0.5 * (3.0 - std::sqrt(5.0));  // of a turn
  std::vector<Vec3> result;
  for (std::size_t k = 0; k < kCount; ++k) {
    const auto i = static_cast<double>(k * kStride % kCount);
    const double z = 1.0 - (2.0 * i + 1.0) / static_cast<double>(kCount);
    const double radius = std::sqrt(1.0 - z * z);
    const Direction around = direction(golden * i - std::floor(golden * i));
    result.emplace_back(radius * around.cosine, radius * around.sine, z);
  }
  return result;
}

std::array<Vec3, 3> places(const OrderedSurface& mesh, OrderedFace face) {
  const auto [a, b, c] = mesh.corners(face);
  return {mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)};
}

/// Whether a line along an edge of the first triangle has the second one on its other side.
bool is_parted_by_edge(const std::array<Vec3, 3>& one, const std::array<Vec3, 3>& other,
                       const Vec3& normal, double slack) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &from = one[k], &tip = one[(k + 2) % 3];
    const Vec3 across = normal.cross(one[(k + 1) % 3] - from).stableNormalized();
    const Vec3 outward = across.dot(tip - from) > 0.0 ? Vec3(-across) : across;
    if (std::all_of(other.begin(), other.end(),
                    [&](const Vec3& p) { return outward.dot(p - from) >= -slack; }))
      return true;
  }
  return false;
}

/// Whether two triangles in one plane have more in common than an edge or a corner.
bool overlap(const std::array<Vec3, 3>& one, const std::array<Vec3, 3>& other, const Vec3& normal,
             double slack) {
  return !is_parted_by_edge(one, other, normal, slack) &&
         !is_parted_by_edge(other, one, normal, slack);
}

}  // namespace

Sky::Sky(const Surface& surface, const Context* context)
    : surface_(surface), projector_(surface, false, context), directions_(sky_directions()) {
  const auto free = [this](const Vec3& place, const Vec3& normal) {
    return free_on_sides(place, normal);
  };
  sides_ = outer_sides(surface, free, context);
}

Ray Sky::ray_from(const Vec3& place, const Vec3& normal, const Vec3& direction) const {
  constexpr double kForever = 1e30;
  return {place + projector_.resolution() * normal, direction, kForever};
}

bool Sky::is_free(const Vec3& place, const Vec3& normal, const Vec3& direction) const {
  return !projector_.is_blocked(ray_from(place, normal, direction));
}

bool Sky::is_outside(std::int32_t face, std::size_t side) const {
  const Sides sides = sides_[static_cast<std::size_t>(face)];
  return sides == Sides::kBoth || (sides == Sides::kFront) == (side == 0);
}

std::array<double, 2> Sky::free_on_sides(const Vec3& place, const Vec3& normal) const {
  std::array<double, 2> free{}, all{};
  for (const Vec3& direction : directions_) {
    const double above = direction.dot(normal);
    const std::size_t side = above > 0.0 ? 0 : 1;
    all[side] += 1.0;
    if (is_free(place, above > 0.0 ? normal : Vec3(-normal), direction)) free[side] += 1.0;
  }
  return {free[0] / std::max(all[0], 1.0), free[1] / std::max(all[1], 1.0)};
}

double Sky::exposure(const Vec3& place, const Vec3& normal, std::int32_t face) const {
  const std::array<double, 2> free = free_on_sides(place, normal);
  return std::max(is_outside(face, 0) ? free[0] : 0.0, is_outside(face, 1) ? free[1] : 0.0);
}

bool Sky::sees(const Vec3& place, const Vec3& normal, std::int32_t face, double least) const {
  return (is_outside(face, 0) && sees_over(place, normal, least)) ||
         (is_outside(face, 1) && sees_over(place, -normal, least));
}

bool Sky::sees_over(const Vec3& place, const Vec3& normal, double least) const {
  const auto is_above = [&](const Vec3& direction) { return direction.dot(normal) > 0.0; };
  const auto all = static_cast<double>(std::ranges::count_if(directions_, is_above));
  const double inside = std::min(kInsideMost, kInsideRatio * least);
  const double needed = std::max(1.0, std::ceil(least * all));
  const double enough = std::max(needed, inside * all);
  double free = 0.0, left = all;
  std::vector<Ray> blocked;
  for (const Vec3& direction : directions_) {
    if (!is_above(direction)) continue;
    if (free + left < needed) return false;
    left -= 1.0;
    const Ray ray = ray_from(place, normal, direction);
    if (projector_.is_blocked(ray)) {
      blocked.push_back(ray);
      continue;
    }
    free += 1.0;
    // In the open this is known after few rays.
    if (free >= enough || (free == needed && inner_share(blocked) == 0.0)) return true;
  }
  const double hollow = inner_share(blocked) * (1.0 - free / all);
  return free >= needed + hollow * (enough - needed);
}

double Sky::inner_share(std::span<const Ray> rays) const {
  if (rays.empty()) return 0.0;
  const std::vector<std::int32_t> hits =
      projector_.first_hits(rays.first(std::min(rays.size(), kInnerRays)));
  const OrderedSurface& mesh = surface_.ordered();
  double inner = 0.0;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    if (hits[k] < 0) continue;
    const double along = rays[k].direction.dot(mesh.geometry(mesh.ordered_face(hits[k])).normal);
    if (!is_outside(hits[k], along < 0.0 ? 0 : 1)) inner += 1.0;
  }
  return inner / static_cast<double>(hits.size());
}

bool Sky::lie_on_each_other(std::int32_t a, std::int32_t b) const {
  const OrderedSurface& mesh = surface_.ordered();
  const OrderedFace one = mesh.ordered_face(a), other = mesh.ordered_face(b);
  if (std::abs(mesh.geometry(one).normal.dot(mesh.geometry(other).normal)) < kParallel)
    return false;
  return !share_vertex(mesh.welded_corners(one), mesh.welded_corners(other)) ||
         overlap(places(mesh, one), places(mesh, other), mesh.geometry(one).normal,
                 projector_.resolution());
}

bool Sky::is_covered(const Vec3& place, std::int32_t face) const {
  const double radius = projector_.resolution();
  const auto near = projector_.faces_within({&place, 1}, {&radius, 1});
  return std::any_of(near[0].begin(), near[0].end(), [&](std::int32_t other) {
    return other < face && lie_on_each_other(other, face);
  });
}

}  // namespace dapple
