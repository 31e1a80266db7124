// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "start/dart_grid.hpp"

namespace dapple::test {
namespace {

constexpr double kRadius = 0.1;

/// Positions that are more cells away from the origin than an integer can count.
TEST(DartGrid, TakesPlacesBeyondAllCells) {
  const auto near = [](const DartGrid::Member& member) { return member.radius; };
  for (const double cell : {1e-15, 1e-300}) {
    DartGrid grid(cell, 0.0);
    Dart dart{};
    for (const double x : {1e10, -1e10, 1e300}) {
      dart.position = {x, 1.0, -x};
      EXPECT_FALSE(grid.refuses(dart, 1e-16, near));
      grid.insert(dart, 1e-16);
      EXPECT_TRUE(grid.refuses(dart, 1e-16, near));
    }
  }
}

std::vector<Dart> random_darts(std::size_t count, double extent, std::uint64_t seed) {
  Random random(seed);
  std::vector<Dart> darts(count);
  for (Dart& dart : darts) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    dart.position = extent * Vec3(x, y, z);
  }
  return darts;
}

/// Members of different sizes, tested by darts of different sizes, some of which were rejected
/// before.
void expect_many_are_answered_as_one_by_one(double period, double extent) {
  DartGrid grid(1.5 * kRadius, period);
  for (const Dart& dart : random_darts(400, extent, 1))
    grid.insert(dart, kRadius * (0.3 + 0.7 * dart.position.x() / extent));
  const std::vector<Dart> darts = random_darts(1000, extent, 2);
  std::vector<DartGrid::Asked> asked;
  for (std::size_t k = 0; k < darts.size(); ++k)
    asked.push_back({&darts[k], k % 2 == 0 ? kRadius : 0.4 * kRadius, k % 7 == 0});
  const auto reach = [](const DartGrid::Asked& one, const DartGrid::Member& other) {
    return std::min(one.most, other.radius);
  };
  grid.refuse(asked, reach);
  std::size_t refused = 0;
  for (std::size_t k = 0; k < darts.size(); ++k) {
    const bool alone = grid.refuses(darts[k], asked[k].most, [&](const DartGrid::Member& other) {
      return reach(asked[k], other);
    });
    EXPECT_EQ(asked[k].refused, alone || k % 7 == 0) << k;
    refused += alone ? 1 : 0;
  }
  EXPECT_GT(refused, 100u);
  EXPECT_LT(refused, 900u);
}

TEST(DartGrid, AnswersManyAsOneByOne) {
  expect_many_are_answered_as_one_by_one(0.0, 0.7);
  expect_many_are_answered_as_one_by_one(0.7, 0.7);
}

TEST(DartGrid, ForgetsItsMembers) {
  DartGrid grid(kRadius, 0.0);
  const std::vector<Dart> darts = random_darts(100, 1.0, 3);
  for (const Dart& dart : darts) grid.insert(dart, kRadius);
  grid.clear();
  const auto reach = [](const DartGrid::Member& member) { return member.radius; };
  for (const Dart& dart : darts) EXPECT_FALSE(grid.refuses(dart, kRadius, reach));
  grid.insert(darts[0], kRadius);
  EXPECT_TRUE(grid.refuses(darts[0], kRadius, reach));
}

}  // namespace
}  // namespace dapple::test
