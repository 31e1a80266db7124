// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/solids.hpp>
#include <limits>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Pair = std::array<std::int32_t, 2>;

/// A box that was turned and moved: the corners, and the distance of a place from it.
struct TurnedBox {
  Vec3 middle, half;
  Eigen::Matrix3d axes;

  [[nodiscard]] std::vector<Vec3> corners() const {
    std::vector<Vec3> found;
    for (int k = 0; k < 8; ++k) {
      const Vec3 sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      found.emplace_back(middle + axes * half.cwiseProduct(sign));
    }
    return found;
  }

  [[nodiscard]] double distance(const Vec3& place) const {
    const Vec3 own = (axes.transpose() * (place - middle)).cwiseAbs() - half;
    return own.cwiseMax(0.0).norm();
  }
};

TurnedBox random_box(Random& random) {
  const Vec3 axis = random.in_box().normalized();
  const Eigen::AngleAxisd turn(random.between(0.0, 3.0), axis);
  const Vec3 half(random.between(0.0, 0.6), random.between(0.0, 0.1), random.between(0.05, 0.3));
  return {random.in_box(), half, turn.toRotationMatrix()};
}

std::vector<Vec3> joined_corners(const std::vector<TurnedBox>& boxes) {
  std::vector<Vec3> points;
  for (const TurnedBox& box : boxes)
    for (const Vec3& corner : box.corners()) points.push_back(corner);
  return points;
}

/// The least and the largest distance of places of a triangle from a box.
std::array<double, 2> distances(const std::array<Vec3, 3>& face, const TurnedBox& box) {
  constexpr int kSteps = 40;
  std::array<double, 2> found = {std::numeric_limits<double>::infinity(), 0.0};
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = double(i) / kSteps, v = double(j) / kSteps;
      const double away = box.distance(u * face[0] + v * face[1] + (1.0 - u - v) * face[2]);
      found = {std::min(found[0], away), std::max(found[1], away)};
    }
  return found;
}

TEST(Solids, ReachTheFacesThatTheirPlacesAreNear) {
  Random random(3);
  std::vector<TurnedBox> boxes;
  for (int k = 0; k < 12; ++k) boxes.push_back(random_box(random));
  const std::vector<Vec3> points = joined_corners(boxes);
  const std::vector<std::int32_t> counts(boxes.size(), 8);
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  for (std::int32_t f = 0; f < 300; ++f) {
    const Vec3 center = random.in_box();
    for (int k = 0; k < 3; ++k) vertices.emplace_back(center + 0.15 * random.in_box());
    faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  std::array<int, 3> met = {};
  for (const double margin : {0.0, 0.07}) {
    const auto found = reached_by_solids(vertices, faces, {points, counts, margin});
    for (std::size_t f = 0; f < faces.size(); ++f) {
      double least = std::numeric_limits<double>::infinity(), inner = least;
      for (const TurnedBox& box : boxes) {
        const auto [low, high] =
            distances({vertices[3 * f], vertices[3 * f + 1], vertices[3 * f + 2]}, box);
        least = std::min(least, low);
        inner = std::min(inner, high);
      }
      ++met[static_cast<std::size_t>(found[f])];
      if (least <= margin) {
        EXPECT_NE(found[f], Reach::kClear) << f;
      }
      if (least > margin + 0.02) {  // longer than from a place to the next one that was tried
        EXPECT_EQ(found[f], Reach::kClear) << f;
      }
      EXPECT_EQ(found[f] == Reach::kInside, inner <= margin) << f;
    }
  }
  for (const int count : met) EXPECT_GT(count, 5);
}

TEST(Solids, MayBeFlatALineOrAPoint) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Face> faces = {{0, 1, 2}};
  const auto reach = [&](const std::vector<Vec3>& points, double margin) {
    const std::vector<std::int32_t> counts = {0, static_cast<std::int32_t>(points.size()), 0};
    return reached_by_solids(vertices, faces, {points, counts, margin})[0];
  };
  const std::vector<Vec3> sheet = {{-1, -1, 0}, {3, -1, 0}, {3, 3, 0}, {-1, 3, 0}};
  EXPECT_EQ(reach(sheet, 0.0), Reach::kInside);  // in the same plane
  const std::vector<Vec3> above = {{-1, -1, 0.1}, {3, -1, 0.1}, {3, 3, 0.1}, {-1, 3, 0.1}};
  EXPECT_EQ(reach(above, 0.0999), Reach::kClear);
  EXPECT_EQ(reach(above, 0.1001), Reach::kInside);
  EXPECT_EQ(reach({{0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.2, 0.2, 0.5}}, 0.0), Reach::kPartly);
  EXPECT_EQ(reach({{2, 2, -1}, {2, 2, 1}}, 1.0), Reach::kClear);
  EXPECT_EQ(reach({{0.3, 0.3, 0.2}}, 0.19), Reach::kClear);
  EXPECT_EQ(reach({{0.3, 0.3, 0.2}, {0.3, 0.3, 0.2}}, 0.21), Reach::kPartly);
  EXPECT_EQ(reach({}, 1.0), Reach::kClear);
}

TEST(Solids, ReachFacesWithoutArea) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Face> faces = {{0, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  const TurnedBox box{{0.5, 0, 0}, {0.2, 0.2, 0.2}, Eigen::Matrix3d::Identity()};
  const std::vector<Vec3> points = box.corners();
  const std::vector<std::int32_t> counts = {8};
  const std::vector<Reach> expected = {Reach::kPartly, Reach::kClear, Reach::kClear};
  EXPECT_EQ(reached_by_solids(vertices, faces, {points, counts, 0.0}), expected);
}

TEST(Solids, FarFromTheOriginAreFoundAsNearIt) {
  for (const double away : {0.0, 1e6}) {
    std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<Vec3> points = {{0.2, 0.2, 0.01}, {0.4, 0.2, 0.01}, {0.2, 0.3, 0.5}, {1, 1, 1}};
    for (Vec3& place : vertices) place.x() += away;
    for (Vec3& place : points) place.x() += away;
    const std::vector<Face> faces = {{0, 1, 2}};
    const std::vector<std::int32_t> counts = {4};
    EXPECT_EQ(reached_by_solids(vertices, faces, {points, counts, 0.009})[0], Reach::kClear);
    EXPECT_EQ(reached_by_solids(vertices, faces, {points, counts, 0.011})[0], Reach::kPartly);
  }
}

TEST(Solids, TouchWhereTheirMarginsMeet) {
  std::vector<TurnedBox> boxes;
  for (int k = 0; k < 40; ++k)
    boxes.push_back({Vec3(1.5 * (k % 8), 2.0 * (k / 8), 0.0), Vec3::Constant(0.5),
                     Eigen::Matrix3d::Identity()});
  const std::vector<Vec3> points = joined_corners(boxes);
  const std::vector<std::int32_t> counts(boxes.size(), 8);
  EXPECT_TRUE(touching_solids({points, counts, 0.24}).empty());
  const std::vector<Pair> rows = touching_solids({points, counts, 0.26});
  EXPECT_EQ(rows.size(), 35u);  // along x
  for (const auto& [one, other] : rows) EXPECT_EQ(one + 1, other);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
}

TEST(Solids, TouchWhatIsInsideThem) {
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  const std::vector<TurnedBox> boxes = {{Vec3::Zero(), Vec3::Ones(), axes},
                                        {Vec3(0.2, 0.1, 0.3), Vec3::Constant(0.1), axes},
                                        {Vec3(3.0, 0.1, 0.3), Vec3::Constant(0.1), axes}};
  const std::vector<Vec3> points = joined_corners(boxes);
  const std::vector<std::int32_t> counts = {8, 8, 0, 8};
  EXPECT_EQ(touching_solids({points, counts}), (std::vector<Pair>{{0, 1}}));
}

TEST(Solids, NameWhatIsWrong) {
  const std::vector<Vec3> vertices = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  const std::vector<Face> faces = {{0, 1, 2}}, missing = {{0, 1, 3}};
  std::vector<Vec3> points(4, Vec3::Zero());
  std::vector<std::int32_t> counts = {4};
  const auto refused = [&](std::initializer_list<std::string> parts, double margin = 0.0) {
    const Solids solids{points, counts, margin};
    expect_message<ArgumentError>([&] { (void)reached_by_solids(vertices, faces, solids); }, parts);
    expect_message<ArgumentError>([&] { (void)touching_solids(solids); }, parts);
  };
  refused({"margin is -1"}, -1.0);
  refused({"margin is"}, std::nan(""));
  counts = {3};
  refused({"counts do not sum up to the 4 points"});
  counts = {3, 2};
  refused({"counts do not sum up to the 4 points"});
  counts = {5, -1};
  refused({"counts do not sum up to the 4 points"});
  counts = {4, -1};
  refused({"counts[1] is -1"});
  counts = {4};
  points[2].y() = std::nan("");
  refused({"points[2]", "not finite"});
  points[2].y() = 0.0;
  EXPECT_THROW((void)reached_by_solids(vertices, missing, {points, counts}), ArgumentError);
}

}  // namespace
}  // namespace dapple::test
