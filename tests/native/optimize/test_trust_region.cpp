// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "optimize/step_limit.hpp"
#include "optimize/trust_region.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

struct Fixture {
  explicit Fixture(Start start) {
    problem.all = std::make_shared<const SurfaceDomain>(blob(3).surface());
    problem.classes.push_back({problem.all, 80});
    objective = make_objective(problem, class_of_sites(problem), {});
    state = evaluate(objective, make_start(problem, start, 1, nullptr), nullptr);
    shrink_radii(objective, state);
  }

  ClassProblem problem;
  Objective objective;
  Evaluation state;
  LbfgsHistory history = LbfgsHistory(7);
};

TEST(TrustRegion, StepsDescendWithinTheLongestStep) {
  for (const Start start : {Start::kRandom, Start::kPoisson}) {
    Fixture f(start);
    for (const bool careful : {false, true}) {
      TrustRegion region(0.5, /*exact=*/false, careful);
      const Vectors step = region.step(f.objective, f.state, f.history);
      EXPECT_LT(dot(step, f.state.gradient), 0.0);
      EXPECT_LE(step_excess(f.objective, f.state, 0.5, step), 1.0 + 1e-12);
    }
  }
}

TEST(TrustRegion, AMoveThatIsTooLongShortensNoOtherMove) {
  Fixture f(Start::kRandom);
  const auto length = [&](bool careful) {
    TrustRegion region(0.5, false, careful);
    const Vectors step = region.step(f.objective, f.state, f.history);
    return std::sqrt(dot(step, step));
  };
  EXPECT_GT(length(false), 2.0 * length(true));
}

TEST(TrustRegion, ShrinksAfterFailuresAndGrowsAgain) {
  Fixture f(Start::kPoisson);
  TrustRegion region(0.5, false, false);
  const auto length = [&] {
    TrustRegion now = region;  // a step may change delta
    const Vectors step = now.step(f.objective, f.state, f.history);
    return std::sqrt(dot(step, step));
  };
  const double first = length();
  region.update_radius(/*found=*/false, 1.0);
  const double failed = length();
  EXPECT_LT(failed, first);
  EXPECT_FALSE(region.follows_model());
  for (int k = 0; k < 10; ++k) region.update_radius(true, 1.0);
  EXPECT_EQ(length(), first) << "no larger than at the least delta";
  EXPECT_TRUE(region.follows_model());
}

TEST(TrustRegion, PredictsLittleNearTheMinimum) {
  Fixture random(Start::kRandom), poisson(Start::kPoisson);
  TrustRegion region(0.5, false, false);
  EXPECT_GT(region.promised(random.objective, random.state),
            region.promised(poisson.objective, poisson.state));
  EXPECT_GT(region.promised(poisson.objective, poisson.state), 0.0);
}

}  // namespace
}  // namespace dapple::test
