// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/vectors.hpp"
#include "surface/ordered_surface.hpp"

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

bool same_bytes(const Vec3& a, const Vec3& b) {
  return std::ranges::equal(std::as_bytes(std::span(a.data(), 3)),
                            std::as_bytes(std::span(b.data(), 3)));
}

Eigen::Matrix3Xd chosen(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        std::span<const std::int32_t> which) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(which.size()));
  for (std::size_t k = 0; k < which.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) = points.col(which[k]);
  return result;
}

// By least squares (Umeyama 1991).
Motion aligned(std::span<const Vec3> before, const Eigen::Matrix3Xd& after,
               std::span<const std::int32_t> measured) {
  Motion motion;
  const Eigen::Matrix4d similarity =
      Eigen::umeyama(chosen(after, measured), chosen(as_matrix(before), measured), true);
  motion.target.resize(before.size());
  for_each_vector(before.size(), [&](std::size_t v) {
    const Vec3 point = after.col(static_cast<Eigen::Index>(v));
    motion.target[v] = (similarity * point.homogeneous()).head<3>();
  });
  for (std::size_t v = 0; v < before.size(); ++v)
    motion.extent = std::max(motion.extent, (motion.target[v] - before[v]).norm());
  motion.extent /= diagonal(before);
  return motion;
}

}  // namespace

bool has_vertices(const Surface& surface, std::span<const Vec3> vertices) {
  if (vertices.size() != surface.vertex_count()) return false;
  const std::vector<std::int32_t>& original = surface.ordered().connectivity().original_vertex;
  for (std::size_t v = 0; v < original.size(); ++v)
    if (!same_bytes(surface.ordered().vertices()[v],
                    vertices[static_cast<std::size_t>(original[v])]))
      return false;
  return true;
}

Motion motion_between(std::span<const Vec3> before, std::span<const Vec3> after,
                      std::span<const std::int32_t> measured) {
  if (before.empty()) return {};
  Motion best = aligned(before, as_matrix(after), measured);
  if (best.extent < kSmall) return best;
  const Eigen::Matrix3Xd mirror = -as_matrix(after);
  if (Motion mirrored = aligned(before, mirror, measured); mirrored.extent < best.extent)
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
