// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/poisson_start.hpp>

#include "invariants.hpp"
#include "sample/solve_classes.hpp"
#include "sample/subdivided_start.hpp"
#include "sample/surface_classes.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

SampleOptions lattice(double capacity_weight = 1.0) {
  SampleOptions options;
  options.optimizer.capacity_weight = capacity_weight;
  return options;
}

ClassProblem problem_of(const Surface& surface, std::size_t count) {
  const SampleClass all{.count = count};
  return surface_classes(surface, {&all, 1}, Cells::kConnected);
}

double order_of(const Surface& surface, std::size_t count, const SampleOptions& options) {
  const Samples samples = sample(surface, count, options);
  EXPECT_EQ(samples.size(), count);
  check(surface, samples);
  return samples.report.bond_order;
}

TEST(SubdividedStart, HasTheCountAndIsNearlyALattice) {
  const Surface surface = blob(4).surface();
  for (const std::size_t count : {600u, 1001u, 2999u}) {
    const ClassProblem problem = problem_of(surface, count);
    const ClassOptions options = options_of_one(lattice());
    ASSERT_TRUE(can_subdivide(problem, options));
    const SubdividedStart start = subdivided_start(problem, options, nullptr);
    EXPECT_EQ(start.sites.size(), count);
    EXPECT_GT(start.evaluations, 4) << "those of a quarter, of a quarter of it and so on";
    EXPECT_LT(start.evaluations, 12);
    EXPECT_LT(evaluate_energy(surface, start.sites, 0.0).normalized, 0.175)
        << "0.160 is a lattice, 0.2 a Poisson-disk set";
  }
}

TEST(SubdividedStart, GivesLargerPatchesForTheSameWork) {
  const Surface surface = blob(4).surface();
  SampleOptions options = lattice();
  options.optimizer.max_evaluations = 12;
  const double few = order_of(surface, 3000, options);
  SampleOptions anew = options;
  anew.start = Start::kRandom;
  anew.optimizer.max_evaluations = 21;  // as many, with those of a quarter
  EXPECT_GT(few, order_of(surface, 3000, anew) + 0.03);
}

TEST(SubdividedStart, KeepsToPointsOfLines) {
  const Surface surface = grid(40).surface();
  ClassProblem problem = problem_of(surface, 2400);
  std::size_t asked = 0;
  problem.classes[0].locked_among = [&](std::size_t count) {
    ++asked;
    return poisson_start(surface, count / 20, 1);
  };
  problem.classes[0].locked = problem.classes[0].locked_among(2400);
  const ClassOptions options = options_of_one(lattice());
  ASSERT_TRUE(can_subdivide(problem, options));
  const SubdividedStart start = subdivided_start(problem, options, nullptr);
  ASSERT_EQ(start.sites.size(), 2400u);
  EXPECT_GE(asked, 3u) << "coarser levels have their own";
  for (std::size_t k = 0; k < 120; ++k)
    EXPECT_EQ(start.sites.positions[k], problem.classes[0].locked.positions[k]);
}

TEST(SubdividedStart, IsForLatticesOfFreeSitesOnly) {
  const Surface surface = blob(4).surface();
  const auto can = [&](std::size_t count, const SampleOptions& options) {
    return can_subdivide(problem_of(surface, count), options_of_one(options));
  };
  EXPECT_TRUE(can(1000, lattice()));
  EXPECT_FALSE(can(1000, {})) << "natural patterns";
  EXPECT_FALSE(can(599, lattice())) << "a quarter is too few";
  SampleOptions other = lattice();
  other.start = Start::kRandom;
  EXPECT_FALSE(can(1000, other));
  other = lattice();
  other.optimizer.method = Method::kLineSearch;
  EXPECT_FALSE(can(1000, other)) << "the paper's method";
  ClassProblem held = problem_of(surface, 1000);
  held.classes[0].locked = poisson_start(surface, 3, 1);
  EXPECT_FALSE(can_subdivide(held, options_of_one(lattice())));
}

TEST(SubdividedStart, LeavesWhatFewSitesDoNotResolve) {
  Shape rods{"Rods", {}, {}};
  for (int k = 0; k < 60; ++k)
    rods = joined(rods, mapped(box(4), [=](const Vec3& p) {
                    return Vec3(p.x(), 0.02 * p.y() + 0.3 * k, 0.02 * p.z());
                  }));
  const Surface surface = rods.surface();
  const Samples samples = sample(surface, 900, lattice());
  EXPECT_EQ(samples.size(), 900u);
  check(surface, samples);
  EXPECT_LT(samples.report.evenness.capacity_variation, 0.05);
}

class SubdividedOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, SubdividedOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(SubdividedOn, KeepsTheInvariantsForAnyNumberOfThreads) {
  const Surface surface = GetParam().surface();
  SampleOptions options = lattice(0.0);
  options.optimizer.max_evaluations = 4;
  options.threads = 1;
  const Samples base = sample(surface, 620, options);
  ASSERT_EQ(base.size(), 620u);
  check(surface, base);
  check_where_dense(surface, base);
  options.threads = 2;
  EXPECT_TRUE(same_bytes(sample(surface, 620, options), base));
}

TEST(SubdividedStart, CanBeCancelled) {
  const Surface surface = blob(4).surface();
  Context context;
  context.cancel();
  EXPECT_THROW(
      (void)subdivided_start(problem_of(surface, 1000), options_of_one(lattice()), &context),
      Cancelled);
}

}  // namespace
}  // namespace dapple::test
