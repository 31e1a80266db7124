// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/planar.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/sampler.hpp>
#include <numeric>

#include "optimize/objective.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// Three classes on the unit square, two with a density of their own and all with radii.
struct Fixture {
  Fixture() {
    const Surface flat = grid(6).surface();
    std::vector<double> ramp, back;
    for (const Vec3& x : flat.vertices()) {
      ramp.push_back(0.2 + x.x());
      back.push_back(1.2 - x.x());
    }
    surfaces = {flat, flat.with_density({DensityAt::kVertices, ramp}),
                flat.with_density({DensityAt::kVertices, back})};
    for (const Surface& surface : surfaces)
      problem.classes.push_back({std::make_shared<const SurfaceDomain>(surface), 20, 0.08});
    problem.all = problem.classes[0].domain;
    objective = make_objective(problem, class_of_sites(problem), {});
    start = make_start(problem, Start::kRandom, 3, nullptr);
    for (Term& term : objective.terms)
      term.radii.assign(term.members.empty() ? start.size() : term.members.size(), 0.2);
  }

  std::vector<Surface> surfaces;
  ClassProblem problem;
  Objective objective;
  Sites start;
};

/// Compare the gradient at every `stride`-th site with finite differences.
void expect_slope_along_x(const Fixture& f, const Evaluation& state, std::size_t every) {
  constexpr double kStep = 1e-7;
  for (std::size_t k = 0; k < f.start.size(); k += every) {
    const auto total = [&](double step) {
      Sites moved = f.start;
      moved.positions[k].x() += step;
      return evaluate(f.objective, f.objective.project(moved.positions, moved.faces), nullptr)
          .total;
    };
    EXPECT_NEAR((total(kStep) - total(-kStep)) / (2.0 * kStep), state.gradient[k].x(),
                1e-5 * (1.0 + std::abs(state.gradient[k].x())))
        << "site " << k;
  }
}

TEST(Objective, HasOneTermForAllAndOneForEachClass) {
  const Fixture f;
  ASSERT_EQ(f.objective.terms.size(), 4u);
  EXPECT_TRUE(f.objective.terms[0].members.empty());
  EXPECT_DOUBLE_EQ(f.objective.terms[0].weight, 3.0);  // mu N
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(f.objective.terms[c + 1].members.size(), 20u);
    EXPECT_EQ(f.objective.terms[c + 1].members[0], static_cast<std::int32_t>(20 * c));
  }
}

TEST(Objective, GradientIsThatOfTheTotal) {
  const Fixture f;
  const Evaluation state = evaluate(f.objective, f.start, nullptr);
  ASSERT_FALSE(state.discs.pairs.empty());
  ASSERT_FALSE(state.parts[0].repulsion.pairs.empty());
  double largest = 0.0;
  for (const Vec3& g : state.gradient) largest = std::max(largest, g.norm());
  constexpr double kStep = 1e-7;
  for (std::size_t k = 0; k < f.start.size(); k += 7)
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
      const auto total = [&](double step) {
        Sites moved = f.start;
        moved.positions[k] += step * along;
        return evaluate(f.objective, f.objective.project(moved.positions, moved.faces), nullptr)
            .total;
      };
      EXPECT_NEAR((total(kStep) - total(-kStep)) / (2.0 * kStep), state.gradient[k].dot(along),
                  1e-5 * largest)
          << "site " << k;
    }
}

TEST(Objective, AnchorsHaveAnExactGradient) {
  Fixture f;
  Vectors anchors = f.start.positions;
  for (std::size_t k = 0; k < anchors.size(); ++k)
    anchors[k] += Vec3(0.03, -0.01 * double(k % 3), 0);
  Evaluation state = evaluate(f.objective, f.start, nullptr);
  const double without = state.total;
  anchor(f.objective, state, anchors, {.stickiness = 0.7, .smoothing = 0.4});
  double added = 0.0;
  for (std::size_t k = 0; k < anchors.size(); ++k)
    added += f.objective.anchoring.energy(f.start.positions, k);
  EXPECT_GT(added, 0.0);
  EXPECT_NEAR(state.total - without, added, 1e-12 * state.total);
  expect_slope_along_x(f, state, 7);
}

/// Five of sixty sites have discs larger than the mean cell.
struct FixtureWithLargeDiscs : Fixture {
  FixtureWithLargeDiscs() {
    objective.discs.assign(start.size(), 0.02);
    for (std::size_t k = 0; k < 5; ++k) objective.discs[12 * k] = 0.2;
    state = evaluate(objective, start, nullptr);
    give_room(objective, state);
  }
  Evaluation state;
};

TEST(Objective, GivesLargeDiscsTheirAreaAndTheOthersTheRest) {
  const FixtureWithLargeDiscs f;
  const std::vector<double>& wanted = f.objective.terms[0].wanted;
  ASSERT_EQ(wanted.size(), f.start.size());
  const double mass = f.problem.all->capacity(), mean = mass / static_cast<double>(wanted.size());
  EXPECT_NEAR(std::accumulate(wanted.begin(), wanted.end(), 0.0), mass, 1e-12 * mass);
  // the hexagon around a circle whose radius is half the sum of the radii
  EXPECT_NEAR(wanted[12], 2.0 * std::sqrt(3.0) * 0.11 * 0.11 * mass / f.problem.all->area(), 1e-12);
  EXPECT_LT(wanted[1], mean);
  EXPECT_EQ(wanted[1], wanted[2]);
}

TEST(Objective, GivesLargeDiscsTheirAreaAmongPoints) {
  Fixture f;
  f.objective.discs.assign(f.start.size(), 0.0);
  f.objective.discs[0] = 0.2;
  Evaluation state = evaluate(f.objective, f.start, nullptr);
  give_room(f.objective, state);
  ASSERT_EQ(f.objective.terms[0].wanted.size(), f.start.size());
  EXPECT_NEAR(f.objective.terms[0].wanted[0],
              2.0 * std::sqrt(3.0) * 0.1 * 0.1 * f.problem.all->capacity() / f.problem.all->area(),
              1e-12);
}

TEST(Objective, LeavesCapacitiesEqualWhereDiscsFit) {
  Fixture f;
  for (const double large : {0.01, 0.1}) {  // small discs, and a larger one among points
    f.objective.discs.assign(f.start.size(), large == 0.01 ? 0.01 : 0.0);
    f.objective.discs[0] = large;
    Evaluation state = evaluate(f.objective, f.start, nullptr);
    const double before = state.total;
    give_room(f.objective, state);
    EXPECT_TRUE(f.objective.terms[0].wanted.empty());
    EXPECT_EQ(state.total, before);
  }
}

TEST(Objective, WithRoomForDiscsHasAnExactGradient) {
  const FixtureWithLargeDiscs f;
  expect_slope_along_x(f, f.state, 6);
}

TEST(Objective, SharesOfTheEnergyAddUpToItsDifferences) {
  const FixtureWithLargeDiscs f;
  const Evaluation& one = f.state;
  Sites moved = f.start;
  for (Vec3& p : moved.positions) p.x() += 0.02 * std::sin(40.0 * p.y());
  const Evaluation two =
      evaluate(f.objective, f.objective.project(moved.positions, moved.faces), nullptr);
  double difference = 0.0;
  const std::vector<double> before = energy_shares(f.objective, one);
  const std::vector<double> after = energy_shares(f.objective, two);
  for (std::size_t k = 0; k < before.size(); ++k) difference += after[k] - before[k];
  EXPECT_NEAR(difference, two.total - one.total, 1e-9 * one.total);
}

TEST(Objective, LockedSitesHaveNoGradient) {
  Fixture f;
  f.objective.locked.assign(f.start.size(), false);
  f.objective.locked[4] = true;
  const Evaluation state = evaluate(f.objective, f.start, nullptr);
  EXPECT_EQ(state.gradient[4], Vec3::Zero());
  EXPECT_NE(state.gradient[5], Vec3::Zero());
}

}  // namespace
}  // namespace dapple::test
