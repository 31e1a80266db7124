// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/crowding.hpp>
#include <dapple/neighbors.hpp>

#include "base/parallel.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

constexpr std::size_t kMostNeighbors = 24;
constexpr double kReach = 3.0;  // relative to the distance of the nearest one

/// \param near  the points around `point`, itself among them, sorted by distance
Vec3 away_from(const Vec3& point, std::span<const Vec3> points, std::span<const Neighbor> near) {
  Vec3 sum = Vec3::Zero();
  if (near.size() < 2) return sum;
  const double reach = kReach * std::sqrt(near[1].squared_distance);
  double weights = 0.0;
  for (const Neighbor& other : near) {
    const double distance = std::sqrt(other.squared_distance);
    if (!(distance > 0.0 && distance < reach)) continue;
    const double share = 1.0 - distance / reach;
    sum += share * share / distance * (point - points[static_cast<std::size_t>(other.index)]);
    weights += share * share;
  }
  return sum / std::max(weights, 1.0);
}

}  // namespace

std::vector<Vec3> away_from_neighbors(std::span<const Vec3> points) {
  check_finite("points", points);
  std::vector<Vec3> found(points.size(), Vec3::Zero());
  const Neighbors tree(points);
  parallel_chunks(points.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t k = begin; k < end; ++k) {
      tree.nearest(points[k], kMostNeighbors + 1, near);
      found[k] = away_from(points[k], points, near);
    }
  });
  return found;
}

}  // namespace dapple
