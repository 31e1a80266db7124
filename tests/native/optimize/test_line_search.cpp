// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "optimize/line_search.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// One site; the energy is a function of how far it has moved along x, with slope -1 at 0.
struct OnALine {
  template <typename Energy>
  Step search(const Energy& energy, const Backtracking& how) {
    Evaluation from;
    from.total = energy(0.0);
    from.gradient = {-Vec3::UnitX()};
    return backtrack({}, from, {Vec3::UnitX()}, how,
                     [&](const Vectors& moves) -> const Evaluation* {
                       if (++evaluations > most) return nullptr;
                       reached.total = energy(moves[0].x());
                       return &reached;
                     });
  }

  Evaluation reached;
  int evaluations = 0, most = 100;
};

TEST(LineSearch, HalvesTheStepUntilTheEnergyFallsEnough) {
  OnALine line;
  const Step step = line.search([](double x) { return 1.0 - x + 2.0 * x * x; }, {});
  ASSERT_TRUE(step.found);
  EXPECT_EQ(step.shortened, 0.25);  // the energy rises at 1 and is unchanged at 0.5
  EXPECT_EQ(line.reached.total, 0.875);
  EXPECT_EQ(line.evaluations, 3);
}

TEST(LineSearch, EndsAfterSoManySteps) {
  OnALine line;
  const Step step = line.search([](double x) { return x > 0.0 ? 2.0 : 1.0; }, {.most = 4});
  EXPECT_FALSE(step.found);
  EXPECT_EQ(line.evaluations, 4);
  EXPECT_EQ(step.jump, 0.0);
}

TEST(LineSearch, GivesUpWhereTheEnergyJumps) {
  OnALine line;
  const Step step =
      line.search([](double x) { return x > 0.0 ? 2.0 - x : 1.0; }, {.gives_up = true});
  EXPECT_FALSE(step.found);
  EXPECT_EQ(line.evaluations, 2);
  EXPECT_NEAR(step.jump, 1.0, 1e-12);
}

TEST(LineSearch, EndsWhereNoEvaluationIsLeft) {
  OnALine line;
  line.most = 2;
  EXPECT_FALSE(line.search([](double x) { return 1.0 + x; }, {}).found);
  EXPECT_EQ(line.evaluations, 3);  // the third step was rejected
}

TEST(LineSearch, DirectionsDescendAndKeepTheLongestStep) {
  ClassProblem problem;
  const Surface surface = blob(3).surface();
  problem.all = std::make_shared<const SurfaceDomain>(surface);
  problem.classes.push_back({problem.all, 80});
  const Objective objective = make_objective(problem, class_of_sites(problem), {});
  const Evaluation state =
      evaluate(objective, make_start(problem, Start::kRandom, 1, nullptr), nullptr);
  LbfgsHistory history(5);
  const Vectors direction = lbfgs_direction(objective, state, 0.5, history);
  EXPECT_LT(dot(direction, state.gradient), 0.0);
  for (std::size_t k = 0; k < direction.size(); ++k)
    EXPECT_LE(direction[k].norm(), 0.5 * local_spacing(objective, state, 0, k) * (1.0 + 1e-12));
}

}  // namespace
}  // namespace dapple::test
