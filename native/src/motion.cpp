// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion.hpp"

#include <Eigen/Geometry>

namespace dapple {
namespace {

constexpr double kSmall = 0.05;  // no mirrored body comes so near

auto as_matrix(std::span<const Vec3> points) {
  return Eigen::Map<const Eigen::Matrix3Xd>(points[0].data(), 3,
                                            static_cast<Eigen::Index>(points.size()));
}

double diagonal(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  return box.diagonal().norm();
}

// By least squares (Umeyama 1991).
Motion aligned(std::span<const Vec3> before, const Eigen::Matrix3Xd& after) {
  Motion motion;
  const Eigen::Matrix4d similarity = Eigen::umeyama(after, as_matrix(before), true);
  for (std::size_t v = 0; v < before.size(); ++v) {
    const Vec3 point = after.col(static_cast<Eigen::Index>(v));
    motion.target.push_back((similarity * point.homogeneous()).head<3>());
    motion.extent = std::max(motion.extent, (motion.target[v] - before[v]).norm());
  }
  motion.extent /= diagonal(before);
  return motion;
}

}  // namespace

Motion motion_between(std::span<const Vec3> before, std::span<const Vec3> after) {
  if (before.empty()) return {};
  Motion best = aligned(before, as_matrix(after));
  if (best.extent < kSmall) return best;
  const Eigen::Matrix3Xd mirror = -as_matrix(after);
  if (Motion mirrored = aligned(before, mirror); mirrored.extent < best.extent)
    best = std::move(mirrored);
  return best;
}

std::vector<Vec3> part_way(std::span<const Vec3> before, const Motion& motion, double t) {
  std::vector<Vec3> result;
  for (std::size_t v = 0; v < before.size(); ++v)
    result.push_back((1.0 - t) * before[v] + t * motion.target[v]);
  return result;
}

}  // namespace dapple
