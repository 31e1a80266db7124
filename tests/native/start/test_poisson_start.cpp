// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/poisson_start.hpp>

#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// The smallest distance between two sites, in spacings.
double least_gap(const Surface& surface, const Sites& sites) {
  const Neighbors tree(sites.positions);
  std::vector<Neighbor> found;
  double squared = std::numeric_limits<double>::infinity();
  for (const Vec3& p : sites.positions) {
    tree.nearest(p, 2, found);
    squared = std::min(squared, found[1].squared_distance);
  }
  return std::sqrt(squared) / surface.spacing(sites.size());
}

using Start = Sites (*)(const Surface&, std::size_t, std::uint64_t);

Sites poisson(const Surface& surface, std::size_t count, std::uint64_t seed) {
  return poisson_start(surface, count, seed);
}

class StartOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, StartOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(StartOn, GivesExactlyTheCountOnTheSurface) {
  const Surface surface = GetParam().surface();
  for (const Start start : {&random_start, &poisson})
    for (const std::size_t count : {0u, 1u, 2u, 3u, 50u, 700u}) {
      const Sites sites = start(surface, count, 5);
      ASSERT_EQ(sites.size(), count);
      check_on_surface(surface, sites, sites.barycentric);
    }
}

TEST_P(StartOn, DependsOnTheSeedAlone) {
  const Surface surface = GetParam().surface();
  for (const Start start : {&random_start, &poisson}) {
    EXPECT_TRUE(same_bytes(start(surface, 100, 3).positions, start(surface, 100, 3).positions));
    EXPECT_FALSE(same_bytes(start(surface, 100, 3).positions, start(surface, 100, 4).positions));
  }
}

TEST(PoissonStart, KeepsAWiderGapThanRandom) {
  for (const Shape& shape : {grid(6), blob(3), box(3), torus(40, 20)}) {
    const Surface surface = shape.surface();
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const double gap = least_gap(surface, poisson_start(surface, 1000, seed));
      const double random_gap = least_gap(surface, random_start(surface, 1000, seed));
      std::cout << shape.name << ": least gap " << gap << " spacings, random " << random_gap
                << '\n';
      EXPECT_GT(gap, 0.5) << shape.name;
      EXPECT_LT(gap, 0.95) << shape.name;  // hexagons have 1; random darts are less regular
      EXPECT_LT(random_gap, 0.2) << shape.name;
    }
  }
}

/// A third of the mass of the density x lies left of sqrt(1/3).
TEST(PoissonStart, FollowsTheDensity) {
  const Shape shape = with_density(grid(8), [](const Vec3& p) { return p.x(); });
  const Surface surface = shape.surface();
  for (const Start start : {&random_start, &poisson}) {
    double left = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      for (const Vec3& p : start(surface, 2000, seed).positions)
        left += p.x() * p.x() < 1.0 / 3.0 ? 1 : 0;
    EXPECT_NEAR(left / 10000.0, 1.0 / 3.0, 0.03);  // six standard deviations of white noise
  }
}

TEST(PoissonStart, FollowsASteepDensity) {
  const Shape shape =
      with_density(grid(20), [](const Vec3& p) { return std::pow(10.0, 4.0 * p.x()); });
  const Surface surface = shape.surface();
  const Sites sites = poisson_start(surface, 3000, 1);
  double right = 0;
  for (const Vec3& p : sites.positions) right += p.x() > 0.75 ? 1 : 0;
  EXPECT_NEAR(right / 3000.0, 0.9, 0.05);
}

TEST(PoissonStart, StaysOffWhatHasNoDensity) {
  const Shape one_vertex =
      with_density(grid(6), [](const Vec3& p) { return p.norm() < 1e-9 ? 2.0 : 0.0; });
  const Surface surface = one_vertex.surface();
  for (const Start start : {&random_start, &poisson})
    for (const Vec3& p : start(surface, 300, 1).positions)
      EXPECT_LE(p.head<2>().maxCoeff(), 1.0 / 6.0 + 1e-12);
}

TEST(PoissonStart, SpreadsOverComponentsByTheirArea) {
  const Shape shape = two_components();
  const Surface surface = shape.surface();
  double share = 0.0;
  for (std::int32_t f = 0; f < 4; ++f) share += shape.face_area(f) / surface.area();
  double first = 0;
  for (const std::int32_t f : poisson_start(surface, 2000, 1).faces) first += f < 4 ? 1 : 0;
  EXPECT_NEAR(first / 2000.0, share, 0.03);
}

TEST(PoissonStart, StopsWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW((void)poisson_start(grid(2).surface(), 100, 1, &context), Cancelled);
}

}  // namespace
}  // namespace dapple::test
