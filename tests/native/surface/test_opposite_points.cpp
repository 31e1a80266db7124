// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "surface/opposite_points.hpp"

namespace dapple::test {
namespace {

constexpr Opposition kOpposition = {0.05, 0.02, -0.8};

/// Points in spatial order on both sides of a sheet that gets thicker along x.
LaidPoints wedge(std::size_t count, double slope) {
  LaidPoints points;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 0.1);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(count), y = uniform(random);
    const double side = k % 2 == 0 ? 1.0 : -1.0;
    points.positions.emplace_back(x, y, 0.5 * side * slope * x);
    points.normals.emplace_back(0.0, 0.0, side);
    points.components.push_back(k % 64 < 60 ? 0 : 1);
  }
  return points;
}

LaidPoints sphere(std::size_t count) {
  LaidPoints points;
  for (std::size_t k = 0; k < count; ++k) {
    const double z = 1.0 - 2.0 * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double angle = static_cast<double>(k) * std::numbers::phi * 2.0 * std::numbers::pi;
    const double r = std::sqrt(1.0 - z * z);
    points.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    points.normals.push_back(points.positions.back());
    points.components.push_back(0);
  }
  return points;
}

/// By comparing all points with each other.
std::size_t opposite_points(const LaidPoints& points) {
  std::size_t found = 0;
  for (std::size_t k = 0; k < points.positions.size(); ++k) {
    bool any = false;
    for (std::size_t m = 0; m < points.positions.size(); ++m) {
      const Vec3 way = points.positions[m] - points.positions[k];
      any = any || (way.norm() < kOpposition.reach &&
                    std::abs(way.dot(points.normals[k])) < kOpposition.depth &&
                    points.components[m] == points.components[k] &&
                    points.normals[m].dot(points.normals[k]) < kOpposition.cosine);
    }
    found += any ? 1 : 0;
  }
  return found;
}

TEST(OppositePoints, AreCountedAsBetweenAllPairs) {
  for (const std::size_t count : {1u, 2u, 15u, 17u, 100u, 1000u, 2500u})
    for (const double slope : {0.0, 0.02, 0.1, 1.0}) {
      const LaidPoints points = wedge(count, slope);
      const std::size_t found = opposite_points(points);
      EXPECT_TRUE(has_opposite_points(points, kOpposition, found)) << count << " " << slope;
      EXPECT_FALSE(has_opposite_points(points, kOpposition, found + 1)) << count << " " << slope;
    }
}

TEST(OppositePoints, AreNotOnASphere) {
  EXPECT_FALSE(has_opposite_points(sphere(3000), kOpposition, 1));
  EXPECT_FALSE(has_opposite_points({}, kOpposition, 1));
}

}  // namespace
}  // namespace dapple::test
