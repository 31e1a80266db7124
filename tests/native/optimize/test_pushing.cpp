// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/sampler.hpp>

#include "optimize/pushing.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// Samples of a blob, of which some stand nearer to a neighbor than the minimum left them.
struct Fixture {
  explicit Fixture(std::size_t count = 800) {
    const Surface surface = blob(4).surface();
    problem.all = std::make_shared<const SurfaceDomain>(surface);
    problem.classes.push_back({problem.all, count});
    objective = make_objective(problem, class_of_sites(problem), {});
    const Samples samples = sample(surface, count);
    found.state =
        evaluate(objective, {samples.positions, samples.faces, samples.barycentric}, nullptr);
  }

  /// Move a site to a distance of so many spacings from its first neighbor.
  void crowd(std::size_t site, double spacings = 0.4) {
    const CellBoundary& side = found.state.diagram().boundary(site)[0];
    const double share =
        1.0 - spacings * local_spacing(objective, found.state, 0, site) / side.offset.norm();
    std::vector<Vec3> moved = found.state.sites.positions;
    moved[site] += share * side.offset;
    found.state = evaluate(objective, objective.project(moved, found.state.sites.faces), nullptr);
  }

  [[nodiscard]] double nearest() const {
    double least = 1.0;
    for (std::size_t k = 0; k < found.state.sites.size(); ++k)
      for (const CellBoundary& side : found.state.diagram().boundary(k))
        least = std::min(least, side.offset.norm() / local_spacing(objective, found.state, 0, k));
    return least;
  }

  ClassProblem problem;
  Objective objective;
  Minimum found;
};

TEST(Pushing, LeadsSitesApartThatAreTooNear) {
  Fixture f;
  for (const std::size_t site : {std::size_t{10}, std::size_t{400}, std::size_t{700}})
    f.crowd(site);
  ASSERT_LT(f.nearest(), 0.45);
  const std::vector<Vec3> before = f.found.state.sites.positions;
  const double variation = capacity_variation(f.objective, f.found.state);
  push_apart(f.objective, 100, f.found, nullptr);
  EXPECT_GE(f.nearest(), 0.63);
  EXPECT_LE(capacity_variation(f.objective, f.found.state), 1.05 * variation);
  EXPECT_LE(f.found.evaluations, 3);
  std::size_t moved = 0;
  for (std::size_t k = 0; k < before.size(); ++k)
    moved += before[k] != f.found.state.sites.positions[k] ? 1 : 0;
  EXPECT_LE(moved, 60U);
}

TEST(Pushing, TakesNoEvaluationWhereNoneAreTooNear) {
  Fixture f;
  const std::vector<Vec3> before = f.found.state.sites.positions;
  push_apart(f.objective, 100, f.found, nullptr);
  EXPECT_EQ(f.found.evaluations, 0);
  EXPECT_EQ(f.found.state.sites.positions, before);
}

TEST(Pushing, DoesNothingWhereManyAreTooNear) {
  Fixture f;
  f.found.state = evaluate(f.objective, make_start(f.problem, Start::kRandom, 1, nullptr), nullptr);
  push_apart(f.objective, 100, f.found, nullptr);
  EXPECT_EQ(f.found.evaluations, 0);
}

TEST(Pushing, LeavesLockedSites) {
  Fixture f;
  f.crowd(10, 0.55);
  f.objective.locked.assign(f.found.state.sites.size(), false);
  f.objective.locked[10] = true;
  const Vec3 before = f.found.state.sites.positions[10];
  push_apart(f.objective, 100, f.found, nullptr);
  EXPECT_EQ(f.found.state.sites.positions[10], before);
  EXPECT_GE(f.nearest(), 0.63);
}

TEST(Pushing, EndsAtTheLimitOfEvaluations) {
  Fixture f;
  f.crowd(10);
  push_apart(f.objective, 0, f.found, nullptr);
  EXPECT_EQ(f.found.evaluations, 0);
  EXPECT_LT(f.nearest(), 0.45);
}

}  // namespace
}  // namespace dapple::test
