// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/vectors.hpp"

namespace dapple {
namespace {

constexpr double kSmall = 0.05;  // extent of a small motion; mirrored bodies have larger values

/// x -> map x + shift.
struct Similarity {
  Eigen::Matrix3d map;
  Vec3 shift;
};

/// A power of two that scales the coordinates to about 1, so that their squares neither overflow
/// nor underflow. It changes no digits.
double unit_of(std::span<const Vec3> points, std::span<const std::int32_t> which) {
  constexpr int kFar = 1000;
  double most = 0.0;
  for (const std::int32_t v : which)
    most = std::max(most, points[static_cast<std::size_t>(v)].cwiseAbs().maxCoeff());
  return most > 0.0 ? std::ldexp(1.0, -std::clamp(std::ilogb(most), -kFar, kFar)) : 1.0;
}

/// The mean of the points, scaled by unit.
Vec3 mean(std::span<const Vec3> points, std::span<const std::int32_t> which, double unit) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t v : which) sum += unit * points[static_cast<std::size_t>(v)];
  return sum / static_cast<double>(which.size());
}

/// The diagonal of a solid box with the same variance, scaled by unit. Unlike the diagonal of the
/// bounding box, it does not depend on the rotation of the body.
double size_of(std::span<const Vec3> points, std::span<const std::int32_t> which, double unit) {
  const Vec3 middle = mean(points, which, unit);
  double spread = 0.0;
  for (const std::int32_t v : which)
    spread += (unit * points[static_cast<std::size_t>(v)] - middle).squaredNorm();
  return std::sqrt(12.0 * spread / static_cast<double>(which.size()));
}

/// The best similarity by least squares (Umeyama 1991). The sums are computed in a fixed order,
/// because Eigen's products choose an order by the processor's caches.
Similarity fitted(std::span<const Vec3> from, std::span<const Vec3> to,
                  std::span<const std::int32_t> which) {
  const double unit_from = unit_of(from, which), unit_to = unit_of(to, which);
  const Vec3 middle_from = mean(from, which, unit_from), middle_to = mean(to, which, unit_to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double spread = 0.0;
  for (const std::int32_t v : which) {
    const Vec3 a = unit_from * from[static_cast<std::size_t>(v)] - middle_from;
    const Vec3 b = unit_to * to[static_cast<std::size_t>(v)] - middle_to;
    for (int axis = 0; axis < 3; ++axis) covariance.col(axis) += a[axis] * b;
    spread += a.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d turn = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const Eigen::Matrix3d map = turn.cwiseProduct(covariance).sum() / spread * turn;
  return {map * (unit_from / unit_to), (middle_to - map * middle_from) / unit_to};
}

/// Per vertex, whether it belongs to one of the faces.
std::vector<bool> of_faces(std::span<const Face> faces, std::size_t count) {
  std::vector<bool> result(count, false);
  for (const Face& face : faces)
    for (const std::int32_t v : face) result[static_cast<std::size_t>(v)] = true;
  return result;
}

/// Vertices without a face keep their position as target.
Motion aligned(std::span<const Vec3> before, std::span<const Vec3> after,
               const std::vector<bool>& moves, std::span<const std::int32_t> measured) {
  Motion motion;
  const Similarity similarity = fitted(after, before, measured);
  motion.target.resize(before.size());
  for_each_vector(before.size(), [&](std::size_t v) {
    motion.target[v] = moves[v] ? Vec3(similarity.map * after[v] + similarity.shift) : before[v];
  });
  const double unit = unit_of(before, measured);
  for (std::size_t v = 0; v < before.size(); ++v)
    motion.extent = std::max(motion.extent, (unit * (motion.target[v] - before[v])).norm());
  motion.extent /= size_of(before, measured, unit);
  return motion;
}

}  // namespace

Motion motion_between(std::span<const Vec3> before, std::span<const Vec3> after,
                      std::span<const Face> faces, std::span<const std::int32_t> measured) {
  if (measured.empty()) return {};
  const std::vector<bool> moves = of_faces(faces, before.size());
  Motion best = aligned(before, after, moves, measured);
  if (best.extent < kSmall) return best;
  Vectors mirror(after.begin(), after.end());
  for (Vec3& point : mirror) point = -point;
  if (Motion mirrored = aligned(before, mirror, moves, measured); mirrored.extent < best.extent)
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
