// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "optimize/slide_limit.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

struct Fixture {
  Fixture() {
    problem.all = std::make_shared<const SurfaceDomain>(blob(3).surface());
    problem.classes.push_back({problem.all, 80});
    objective = make_objective(problem, class_of_sites(problem), {});
    state = evaluate(objective, make_start(problem, Start::kPoisson, 1, nullptr),
                     std::vector<std::vector<double>>(1), nullptr);
    moved = state.sites.positions;
    for (Vec3& x : moved) x += Vec3(0.7, -0.4, 0.2);  // some spacings
  }

  ClassProblem problem;
  Objective objective;
  State state;
  Vectors moved;
};

TEST(SlideLimit, NoSiteEndsFartherThanItMay) {
  const Fixture f;
  SlideLimit limit(f.objective, 0.3);
  limit.set_home(f.state.sites);
  EXPECT_FALSE(limit.exceeded(f.state));
  State next = f.state;
  next.sites = limit.project(f.state, f.moved, f.state.sites.faces);
  const double most = 0.3 * f.problem.all->spacing(80);
  double longest = 0.0;
  for (std::size_t k = 0; k < next.sites.size(); ++k)
    longest =
        std::max(longest, (next.sites.positions[k] - f.state.sites.positions[k]).norm() / most);
  EXPECT_LE(longest, 1.0 + 1e-12);
  EXPECT_GT(longest, 0.5) << "they do move";
}

TEST(SlideLimit, WithoutOneSitesGoWhereTheyAreProjected) {
  const Fixture f;
  const SlideLimit limit(f.objective, std::numeric_limits<double>::infinity());
  const Sites found = limit.project(f.state, f.moved, f.state.sites.faces);
  EXPECT_EQ(found.positions, f.objective.project(f.moved, f.state.sites.faces).positions);
}

TEST(SlideLimit, LockedSitesKeepTheirBytes) {
  Fixture f;
  f.objective.locked.assign(80, false);
  f.objective.locked[5] = true;
  SlideLimit limit(f.objective, 0.3);
  limit.set_home(f.state.sites);
  const Sites found = limit.project(f.state, f.moved, f.state.sites.faces);
  EXPECT_EQ(found.positions[5], f.state.sites.positions[5]);
  EXPECT_NE(found.positions[6], f.state.sites.positions[6]);
}

}  // namespace
}  // namespace dapple::test
