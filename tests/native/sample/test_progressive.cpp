// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/progressive.hpp>
#include <dapple/sampler.hpp>
#include <limits>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

std::vector<Vec3> beginning(const std::vector<Vec3>& points, const std::vector<std::int32_t>& ranks,
                            std::size_t count) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (static_cast<std::size_t>(ranks[k]) < count) kept.push_back(points[k]);
  return kept;
}

struct Distances {
  double smallest, mean;
};

/// The smallest and mean distance to the nearest other point, relative to a hexagonal lattice with
/// the same density.
Distances relative_distances(const std::vector<Vec3>& points, double area) {
  const Neighbors tree(points);
  const double best = std::sqrt(2.0 * area / (std::sqrt(3.0) * static_cast<double>(points.size())));
  std::vector<Neighbor> near;
  Distances found{std::numeric_limits<double>::infinity(), 0.0};
  for (const Vec3& point : points) {
    tree.nearest(point, 2, near);
    const double distance = std::sqrt(near[1].squared_distance) / best;
    found.smallest = std::min(found.smallest, distance);
    found.mean += distance / static_cast<double>(points.size());
  }
  return found;
}

void expect_permutation(std::vector<std::int32_t> ranks) {
  std::sort(ranks.begin(), ranks.end());
  for (std::size_t k = 0; k < ranks.size(); ++k) ASSERT_EQ(ranks[k], static_cast<std::int32_t>(k));
}

TEST(Progressive, EveryBeginningIsEven) {
  const Surface surface = icosphere(4).surface();
  const Samples samples = sample(surface, 2000);
  const auto ranks = progressive_ranks(samples.positions);
  expect_permutation(ranks);
  for (const std::size_t count : {1900u, 1500u, 1000u, 700u, 500u, 200u, 100u, 50u}) {
    const auto [smallest, mean] =
        relative_distances(beginning(samples.positions, ranks, count), surface.area());
    EXPECT_GT(smallest, 0.5) << count << " points";  // a random subset: 0.05 to 0.3
    EXPECT_GT(mean, 0.7) << count << " points";      // a random subset: 0.5
  }
}

TEST(Progressive, KeepsADensity) {
  const Surface surface =
      with_face_density(grid(40), [](const Vec3& p) { return p[0] < 0.5 ? 1.0 : 4.0; }).surface();
  const Samples samples = sample(surface, 1500);
  const auto ranks = progressive_ranks(samples.positions);
  const auto right = [](const std::vector<Vec3>& points) {
    return static_cast<double>(std::count_if(points.begin(), points.end(),
                                             [](const Vec3& p) { return p[0] > 0.5; })) /
           static_cast<double>(points.size());
  };
  const double expected = right(samples.positions);
  for (const std::size_t count : {1000u, 500u, 200u})
    EXPECT_NEAR(right(beginning(samples.positions, ranks, count)), expected, 0.05) << count;
}

TEST(Progressive, ClassesKeepTheirSharesAndAreEvenByThemselves) {
  const Surface surface = icosphere(4).surface();
  const std::vector<SampleClass> classes = {{1200}, {600}, {200}};
  const Samples samples = sample_classes(surface, classes);
  const auto ranks = progressive_ranks(samples.positions, samples.classes);
  expect_permutation(ranks);
  for (const std::size_t count : {1500u, 1000u, 333u, 100u}) {
    for (std::int32_t c = 0; c < 3; ++c) {
      std::vector<Vec3> own;
      for (std::size_t k = 0; k < samples.size(); ++k)
        if (samples.classes[k] == c && static_cast<std::size_t>(ranks[k]) < count)
          own.push_back(samples.positions[k]);
      const double share = static_cast<double>(classes[static_cast<std::size_t>(c)].count) *
                           static_cast<double>(count) / 2000.0;
      EXPECT_NEAR(static_cast<double>(own.size()), share, 1.0) << "class " << c;
      EXPECT_GT(relative_distances(own, surface.area()).mean, 0.6) << count << " of " << c;
    }
    const auto all = relative_distances(beginning(samples.positions, ranks, count), surface.area());
    EXPECT_GT(all.mean, 0.6) << count << " points";
  }
}

TEST(Progressive, TakesFewAndCoincidentPoints) {
  EXPECT_TRUE(progressive_ranks({}).empty());
  const std::vector<Vec3> one = {Vec3::Zero()};
  EXPECT_EQ(progressive_ranks(one), std::vector<std::int32_t>{0});
  const std::vector<Vec3> same(20, Vec3::Ones());
  expect_permutation(progressive_ranks(same));
  const std::vector<std::int32_t> far = {7, 7, 3};
  const std::vector<Vec3> three = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  expect_permutation(progressive_ranks(three, far));
}

TEST(Progressive, RefusesBadArguments) {
  const std::vector<Vec3> bad = {Vec3::Zero(), Vec3(0.0, std::nan(""), 0.0)};
  expect_message<ArgumentError>([&] { (void)progressive_ranks(bad); }, {"points[1]", "nan"});
  const std::vector<Vec3> two = {Vec3::Zero(), Vec3::UnitX()};
  const std::vector<std::int32_t> below = {0, -1}, three = {0, 0, 0};
  expect_message<ArgumentError>([&] { (void)progressive_ranks(two, below); }, {"classes[1]", "-1"});
  expect_message<ArgumentError>([&] { (void)progressive_ranks(two, three); }, {"classes", "3"});
}

}  // namespace
}  // namespace dapple::test
