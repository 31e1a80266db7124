// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/morton.hpp"

namespace dapple::test {
namespace {

TEST(Morton, CellsHaveNumbersWhateverIsAlong) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cell_along(2.9, 7.0), 2u);
  EXPECT_EQ(cell_along(-1.0, 7.0), 0u);
  EXPECT_EQ(cell_along(1e300, 7.0), 7u);
  EXPECT_EQ(cell_along(-infinity, 7.0), 0u);
  EXPECT_EQ(cell_along(std::numeric_limits<double>::quiet_NaN(), 7.0), 0u);
  EXPECT_EQ(cell_along(-std::numeric_limits<double>::quiet_NaN(), 7.0), 0u);
}

TEST(Morton, OrdersPointsWhoseDistanceIsNoNumber) {
  constexpr double most = std::numeric_limits<double>::max();
  const std::vector<Vec3> points = {{most, 0, 0}, {-most, 0, 0}, {0, most, -most}, {0, 0, 0}};
  std::vector<std::int32_t> order = morton_order(points);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<std::int32_t>{0, 1, 2, 3}));
}

TEST(Morton, LeavesPointsOfOnePlaceInTheirOrder) {
  const std::vector<Vec3> points(5, Vec3(3.0, -1.0, 2.0));
  EXPECT_EQ(morton_order(points), (std::vector<std::int32_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace dapple::test
