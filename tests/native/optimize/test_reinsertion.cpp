// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/optimizer.hpp>
#include <dapple/planar.hpp>
#include <dapple/poisson_start.hpp>

#include "invariants.hpp"
#include "optimize/reinsertion.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

double least_capacity(const OptimizerResult& found) {
  double least = std::numeric_limits<double>::infinity();
  for (const Moments& cell : found.energy.diagram.cells) least = std::min(least, cell.capacity);
  return least;
}

class ReinsertionOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ReinsertionOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

/// A quarter of the sites start at the position of another site.
TEST_P(ReinsertionOn, FreesSitesThatStartTogether) {
  const Surface surface = GetParam().surface();
  Sites start = poisson_start(surface, 60, 1);
  for (std::size_t k = 0; k < 15; ++k) {
    start.positions[k] = start.positions[20 + k / 3];
    start.faces[k] = start.faces[20 + k / 3];
    start.barycentric[k] = start.barycentric[20 + k / 3];
  }
  for (const Method method : {Method::kTrustRegion, Method::kLineSearch}) {
    const OptimizerOptions options{.method = method};
    const OptimizerResult found = optimize(SurfaceDomain(surface), start, options);
    EXPECT_GT(least_capacity(found), 0.0);
    EXPECT_TRUE(std::isfinite(found.energy.total));
    EXPECT_TRUE(same_bytes(found.sites.positions,
                           optimize(SurfaceDomain(surface), start, options).sites.positions));
  }
}

TEST(Reinsertion, FreesTwoSitesAtOnePlace) {
  const Surface surface = blob(3).surface();
  Sites start = poisson_start(surface, 1, 1);
  start.positions.push_back(start.positions[0]);
  start.faces.push_back(start.faces[0]);
  start.barycentric.push_back(start.barycentric[0]);
  EXPECT_GT(least_capacity(optimize(SurfaceDomain(surface), start, {})), 0.0);
}

/// There is no normal, and no neighbor that determines a direction.
TEST(Reinsertion, FreesTwoSitesAtOnePlaceOfAFaceWithoutArea) {
  Shape shape = blob(3);
  const auto needle = static_cast<std::int32_t>(shape.faces.size());
  shape.faces.push_back({0, 0, 1});
  const Surface surface = shape.surface();
  const Vec3 weights(0.0, 0.5, 0.5);
  const Sites start{std::vector<Vec3>(2, surface.point(needle, weights)),
                    {needle, needle},
                    std::vector<Vec3>(2, weights)};
  const OptimizerResult found = optimize(SurfaceDomain(surface), start, {});
  EXPECT_TRUE(std::isfinite(found.energy.total));
  EXPECT_GT(least_capacity(found), 0.0);
}

/// On the torus steps are not confined to the support of the density.
TEST(Reinsertion, BringsSitesBackIntoTheDensity) {
  Image image{1, 16, std::vector<double>(16, 0.0)};
  for (std::size_t k = 4; k < 8; ++k) image.values[k] = 1.0;
  const Torus torus(image);
  const Vec2 outside[] = {{0.9, 0.1}, {0.85, 0.5}, {0.3, 0.2}, {0.35, 0.7}};
  const OptimizerResult found = optimize(torus, torus.sites(outside), {});
  EXPECT_GT(least_capacity(found), 0.0);
}

TEST(Reinsertion, LeavesLockedSitesAlone) {
  const Surface surface = blob(2).surface();
  Sites sites = poisson_start(surface, 10, 1);
  sites.positions[3] = sites.positions[7];
  sites.faces[3] = sites.faces[7];
  sites.barycentric[3] = sites.barycentric[7];
  const SurfaceDomain domain(surface);
  Objective objective;
  objective.capacity_weight = 30.0;
  objective.terms.push_back({.domain = &domain});
  const Evaluation state = evaluate(objective, sites, nullptr);
  ASSERT_EQ(find_reinsertion(objective, state).sites, std::vector<std::int32_t>{7});
  objective.locked.assign(10, true);
  EXPECT_TRUE(find_reinsertion(objective, state).sites.empty());
}

}  // namespace
}  // namespace dapple::test
