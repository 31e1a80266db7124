// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numeric>

#include "shapes.hpp"
#include "track/motion.hpp"

namespace dapple::test {
namespace {

Vec3 turned(const Vec3& p) {
  return Eigen::AngleAxisd(2.5, Vec3(1, 2, 3).normalized()) * p + Vec3(5, -7, 1);
}

Motion motion_of(std::span<const Vec3> before, std::span<const Vec3> after) {
  std::vector<std::int32_t> all(before.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Face> faces;
  for (const std::int32_t v : all) faces.push_back({v, v, v});
  return motion_between(before, after, faces, all);
}

TEST(Motion, LeavesOutMovingAsAWhole) {
  const Shape shape = blob(3);
  const Motion motion = motion_of(shape.vertices, mapped(shape, turned).vertices);
  EXPECT_LT(motion.extent, 1e-14);
  for (std::size_t v = 0; v < shape.vertices.size(); ++v)
    EXPECT_LT((motion.target[v] - shape.vertices[v]).norm(), 1e-12);
}

TEST(Motion, MeasuresTheFarthestVertexByTheSize) {
  const Shape shape = box(6);  // unit cube
  Shape moved = shape;
  moved.vertices[10].z() += 0.1;
  const Motion motion = motion_of(shape.vertices, mapped(moved, turned).vertices);
  double spread = 0.0;
  for (const Vec3& p : shape.vertices) spread += (p - Vec3::Constant(0.5)).squaredNorm();
  const double size = std::sqrt(12.0 * spread / static_cast<double>(shape.vertices.size()));
  EXPECT_NEAR(size, std::sqrt(5.0), 0.2);              // size of a cube's surface
  EXPECT_NEAR(motion.extent, 0.1 / size, 0.05 * 0.1);  // the fitted rigid motion absorbs a part
}

TEST(Motion, IsTheSameHoweverTheBodyIsTurned) {
  const Shape shape =
      mapped(blob(3), [](const Vec3& p) { return Vec3(3.0 * p.x(), p.y(), p.z()); });
  const Shape after = mapped(shape, [](const Vec3& p) { return Vec3(p.x(), 1.3 * p.y(), p.z()); });
  const double extent = motion_of(shape.vertices, after.vertices).extent;
  EXPECT_GT(extent, 0.01);
  EXPECT_NEAR(motion_of(mapped(shape, turned).vertices, mapped(after, turned).vertices).extent,
              extent, 1e-14);
}

TEST(Motion, LeavesOutScalingAndMirroring) {
  const Shape shape = blob(3);
  const auto moved = [](const Vec3& p) { return Vec3(3.0 * turned({-p.x(), p.y(), p.z()})); };
  EXPECT_LT(motion_of(shape.vertices, mapped(shape, moved).vertices).extent, 1e-14);
}

TEST(Motion, LeavesOutVerticesOfNoFace) {
  const Shape shape = blob(3);
  Shape before = shape, after = mapped(shape, turned);
  const auto loose = static_cast<std::int32_t>(shape.vertices.size());
  before.vertices.push_back({1, 2, 3});
  for (const double far : {4.0, 1e155, 1e308}) {
    after.vertices.resize(shape.vertices.size());
    after.vertices.push_back({far, -far, far});
    const Surface surface = before.surface();
    const std::vector<std::int32_t> measured = surface.distinct_vertices();
    EXPECT_TRUE(std::ranges::find(measured, loose) == measured.end());
    const Motion motion = motion_between(before.vertices, after.vertices, before.faces, measured);
    EXPECT_LT(motion.extent, 1e-14) << far;
    EXPECT_TRUE(motion.target.back().allFinite()) << far;
  }
}

TEST(Motion, IsTheSameForBodiesOfAnySize) {
  const Shape shape = blob(3);
  const Shape after = mapped(shape, [](const Vec3& p) { return Vec3(p.x(), 1.3 * p.y(), p.z()); });
  const double extent = motion_of(shape.vertices, after.vertices).extent;
  for (const double size : {0x1p-1000, 0x1p-600, 0x1p600, 0x1p1000}) {
    const auto sized = [size](const Vec3& p) { return Vec3(size * p); };
    EXPECT_EQ(motion_of(mapped(shape, sized).vertices, mapped(after, sized).vertices).extent,
              extent);
    EXPECT_NEAR(motion_of(shape.vertices, mapped(after, sized).vertices).extent, extent, 1e-14);
  }
}

TEST(Motion, StretchingOneWayIsMotion) {
  const Shape shape = blob(3);
  const auto moved = [](const Vec3& p) { return Vec3(1.2 * p.x(), p.y(), p.z()); };
  EXPECT_GT(motion_of(shape.vertices, mapped(shape, moved).vertices).extent, 0.01);
}

TEST(Motion, PartWayIsStraight) {
  const Shape shape = blob(2);
  const std::vector<Vec3> after =
      mapped(shape, [](const Vec3& p) { return Vec3(1.2 * p.x(), p.y(), p.z()); }).vertices;
  const Motion motion = motion_of(shape.vertices, after);
  EXPECT_EQ(part_way(shape.vertices, motion, 0.0), shape.vertices);
  EXPECT_EQ(part_way(shape.vertices, motion, 1.0), motion.target);
  const std::vector<Vec3> half = part_way(shape.vertices, motion, 0.5);
  for (std::size_t v = 0; v < half.size(); ++v)
    EXPECT_LT((half[v] - 0.5 * (shape.vertices[v] + motion.target[v])).norm(), 1e-15);
}

}  // namespace
}  // namespace dapple::test
