// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "base/morton.hpp"
#include "base/random.hpp"
#include "base/reorder.hpp"
#include "voronoi/site_boxes.hpp"

namespace dapple::test {
namespace {

Vec3 random_point(Random& random) { return {random.uniform(), random.uniform(), random.uniform()}; }

/// Points of the unit cube in the order of a Morton curve.
std::vector<Vec3> sorted_points(std::size_t count) {
  Random random(count);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = random_point(random);
  return gather(std::span<const Vec3>(points), morton_order(points));
}

double squared_distance(const Box& box, const Vec3& p) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).squaredNorm();
}

/// One leaf, a leaf that is not full, several levels.
class SiteBoxesOf : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Counts, SiteBoxesOf, testing::Values(0, 1, 7, 8, 9, 64, 65, 513, 5000));

TEST_P(SiteBoxesOf, FindAllThatAreNear) {
  const std::vector<Vec3> points = sorted_points(GetParam());
  const SiteBoxes boxes(points);
  Random random(7);
  for (const double limit : {0.0, 1e-4, 0.01, 0.3, 4.0, std::numeric_limits<double>::infinity()}) {
    const Vec3 low = random_point(random);
    const Box query = {low, low + 0.05 * random_point(random)};
    std::set<std::size_t> found;
    boxes.for_each_near(query, limit, [&](std::size_t k) {
      EXPECT_TRUE(found.insert(k).second) << "point " << k << " is found twice";
    });
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_EQ(found.contains(k), squared_distance(query, points[k]) < limit)
          << "point " << k << ", limit " << limit;
  }
}

TEST_P(SiteBoxesOf, FindTheSameInTheGroupsAroundAParent) {
  const std::vector<Vec3> points = sorted_points(GetParam());
  const SiteBoxes boxes(points);
  const auto ordered = [](auto&& find) {
    std::vector<std::size_t> found;
    find([&](std::size_t k) { found.push_back(k); });
    return found;
  };
  for (std::size_t point = 0; point < points.size(); point += SiteBoxes::kFan) {
    const Box parent = boxes.block(boxes.neighborhood(point)).box;
    for (const double limit : {1e-4, 0.01, 0.3}) {
      const std::vector<std::size_t> groups =
          ordered([&](auto&& add) { boxes.for_each_group_near(parent, 1.5 * limit, add); });
      const Box leaf = boxes.leaf_of(point);
      EXPECT_EQ(ordered([&](auto&& add) {
                  for (const std::size_t group : groups) boxes.visit_group(group, leaf, limit, add);
                }),
                ordered([&](auto&& add) { boxes.for_each_near(leaf, limit, add); }));
    }
  }
}

TEST_P(SiteBoxesOf, FindTheNearestByASinkingLimit) {
  const std::vector<Vec3> points = sorted_points(GetParam());
  if (points.empty()) return;
  const SiteBoxes boxes(points);
  Random random(11);
  for (int k = 0; k < 50; ++k) {
    const Vec3 query = 2.0 * random_point(random) - Vec3(0.5, 0.5, 0.5);
    double least = std::numeric_limits<double>::infinity(), expected = least;
    boxes.for_each_nearest({query, query}, least, [&](std::size_t p) {
      least = std::min(least, (points[p] - query).squaredNorm());
    });
    for (const Vec3& p : points) expected = std::min(expected, (p - query).squaredNorm());
    EXPECT_EQ(least, expected);
  }
}

TEST(SiteBoxes, HoldTheirPoints) {
  const std::vector<Vec3> points = sorted_points(1000);
  const SiteBoxes boxes(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_EQ(squared_distance(boxes.leaf_of(k), points[k]), 0.0) << "point " << k;
}

}  // namespace
}  // namespace dapple::test
