// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/crowding.hpp>
#include <dapple/errors.hpp>
#include <dapple/neighbors.hpp>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

std::vector<Neighbor> sorted_by_distance(const std::vector<Vec3>& points, const Vec3& query) {
  std::vector<Neighbor> all;
  for (const Vec3& p : points)
    all.push_back({static_cast<std::int32_t>(all.size()), (p - query).squaredNorm()});
  std::sort(all.begin(), all.end(), [](const Neighbor& a, const Neighbor& b) {
    return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
  });
  return all;
}

TEST(Neighbors, GiveNearestDistances) {
  Random random(8);
  std::vector<Vec3> points(300);
  for (Vec3& p : points) p = random.in_box();
  points[7] = points[200];
  const std::vector<double> distances = nearest_distances(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_NEAR(distances[k], std::sqrt(sorted_by_distance(points, points[k])[1].squared_distance),
                1e-14);
  EXPECT_EQ(distances[7], 0.0);
  EXPECT_TRUE(nearest_distances({}).empty());
  const std::vector<Vec3> alone = {Vec3::Zero()};
  EXPECT_TRUE(std::isinf(nearest_distances(alone)[0]));
}

TEST(Neighbors, PointAwayFromThem) {
  std::vector<Vec3> points;
  for (int x = 0; x < 9; ++x)
    for (int y = 0; y < 9; ++y) points.emplace_back(x, y, 0);
  const std::vector<Vec3> away = away_from_neighbors(points);
  const auto at = [&](int x, int y) { return away[static_cast<std::size_t>(9 * x + y)]; };
  EXPECT_NEAR(at(4, 4).norm(), 0.0, 1e-12);
  EXPECT_NEAR(at(8, 4).x(), 0.45, 0.01);
  EXPECT_NEAR(at(8, 4).y(), 0.0, 1e-12);
  EXPECT_GT(at(0, 0).norm(), at(0, 4).norm());
  for (const Vec3& one : away) EXPECT_LE(one.norm(), 1.0);
}

TEST(Neighbors, PointNowhereWithoutThem) {
  EXPECT_TRUE(away_from_neighbors({}).empty());
  const std::vector<Vec3> alone = {Vec3::Zero()};
  EXPECT_EQ(away_from_neighbors(alone)[0], Vec3::Zero());
  const std::vector<Vec3> stacked(40, Vec3::Ones());
  EXPECT_EQ(away_from_neighbors(stacked)[7], Vec3::Zero());
  const std::vector<Vec3> pair = {Vec3::Zero(), Vec3(0.5, 0, 0)};
  EXPECT_NEAR(away_from_neighbors(pair)[0].x(), -4.0 / 9.0, 1e-15);
}

TEST(Neighbors, PointAwayFromFiniteOnesOnly) {
  const std::vector<Vec3> broken = {Vec3(0, std::nan(""), 0)};
  expect_message<ArgumentError>([&] { (void)away_from_neighbors(broken); }, {"points[0]"});
}

TEST(Neighbors, AgreeWithSorting) {
  Random random(2);
  std::vector<Vec3> points(500);
  for (Vec3& p : points) p = random.in_box();
  const Neighbors tree(points);
  std::vector<Neighbor> found;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 query = 1.5 * random.in_box();
    const std::vector<Neighbor> expected = sorted_by_distance(points, query);
    const auto count = static_cast<std::size_t>(1 + random.below(40));
    tree.nearest(query, count, found);
    ASSERT_EQ(found.size(), count);
    for (std::size_t k = 0; k < count; ++k) {
      ASSERT_EQ(found[k].index, expected[k].index);
      ASSERT_NEAR(found[k].squared_distance, expected[k].squared_distance, 1e-14);
    }
  }
}

TEST(Neighbors, SortTiesByIndex) {
  std::vector<Vec3> points;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y) points.emplace_back(x, y, 0);
  points.insert(points.end(), 3, Vec3::Zero());  // copies of the middle point
  const Neighbors tree(points);
  std::vector<Neighbor> found;
  tree.nearest(Vec3::Zero(), points.size(), found);
  const std::vector<Neighbor> expected = sorted_by_distance(points, Vec3::Zero());
  for (std::size_t k = 0; k < points.size(); ++k) EXPECT_EQ(found[k].index, expected[k].index) << k;
}

TEST(Neighbors, GiveAllIfMoreAreRequested) {
  const std::vector<Vec3> points = {{1, 0, 0}, {0, 0, 0}};
  const Neighbors tree(points);
  std::vector<Neighbor> found;
  tree.nearest({0.1, 0, 0}, 10, found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].index, 1);
  tree.nearest({0.1, 0, 0}, 0, found);
  EXPECT_TRUE(found.empty());
}

TEST(Neighbors, AreNoneOfNoPoints) {
  const Neighbors tree(std::vector<Vec3>{});
  std::vector<Neighbor> found = {{1, 1.0}};
  tree.nearest(Vec3::Zero(), 3, found);
  EXPECT_TRUE(found.empty());
}

TEST(Neighbors, HandleManyCopiesOfOnePoint) {
  const std::vector<Vec3> points(300, Vec3(1, 2, 3));
  const Neighbors tree(points);
  std::vector<Neighbor> found;
  tree.nearest({1, 2, 3}, 300, found);
  for (std::size_t k = 0; k < 300; ++k) EXPECT_EQ(found[k].index, static_cast<std::int32_t>(k));
}

}  // namespace
}  // namespace dapple::test
