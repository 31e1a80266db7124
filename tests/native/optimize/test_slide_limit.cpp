// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <limits>

#include "optimize/slide_limit.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

struct Fixture {
  Fixture() : Fixture(blob(3).surface(), {}) {}
  Fixture(const Surface& surface, const std::vector<Vec3>& points) {
    problem.all = std::make_shared<const SurfaceDomain>(surface);
    problem.classes.push_back({problem.all, points.empty() ? 80 : points.size()});
    objective = make_objective(problem, class_of_sites(problem), {});
    state = evaluate(objective,
                     points.empty() ? make_start(problem, Start::kPoisson, 1, nullptr)
                                    : problem.all->project(points, {}),
                     nullptr);
    moved = state.sites.positions;
    for (Vec3& x : moved) x += Vec3(0.7, -0.4, 0.2);  // several spacings
  }

  ClassProblem problem;
  Objective objective;
  Evaluation state;
  Vectors moved;
};

TEST(SlideLimit, NoSiteEndsFartherThanItMay) {
  const Fixture f;
  SlideLimit limit(f.objective, 0.3);
  limit.set_home(f.state.sites);
  EXPECT_FALSE(limit.exceeded(f.state));
  Evaluation next = f.state;
  next.sites = limit.project(f.state, f.moved, f.state.sites.faces);
  const double most = 0.3 * f.problem.all->spacing(80);
  double longest = 0.0;
  for (std::size_t k = 0; k < next.sites.size(); ++k)
    longest =
        std::max(longest, (next.sites.positions[k] - f.state.sites.positions[k]).norm() / most);
  EXPECT_LE(longest, 1.0 + 1e-12);
  EXPECT_GT(longest, 0.5) << "they do move";
}

/// A square with a stripe of no density across it.
Shape divided_square(double stripe) {
  const Shape square = with_face_density(
      grid(8), [](const Vec3& p) { return p.x() > 0.375 && p.x() < 0.5 ? 0.0 : 1.0; });
  return mapped(square, [stripe](const Vec3& p) {
    return Vec3(p.x() < 0.4 ? p.x() : p.x() - 0.125 + stripe, p.y(), p.z());
  });
}

/// A site projected onto the stripe goes to its nearer side. This is the far side, out of reach, if
/// more than half of the stripe's width remains before the site.
TEST(SlideLimit, SitesArePulledBackUntilTheyAreWithinReach) {
  std::vector<Vec3> points;
  for (int k = 0; k < 10; ++k) points.emplace_back(k % 2 == 0 ? 0.3 : 0.7, 0.05 + 0.1 * k, 0.0);
  const double reach = 0.3 * SurfaceDomain(divided_square(0.1).surface()).spacing(points.size());
  // one pull by 0.8 leaves more than half of the stripe, two pulls do not
  const double stripe = 1.3 * reach;
  for (Vec3& x : points) x.x() = x.x() < 0.5 ? 0.375 : 0.375 + stripe;
  Fixture f(divided_square(stripe).surface(), points);
  f.moved = points;
  for (std::size_t k = 0; k < points.size(); ++k)
    f.moved[k].x() += points[k].x() < 0.4 ? 0.99 * reach : -0.99 * reach;
  SlideLimit limit(f.objective, 0.3);
  limit.set_home(f.state.sites);
  const Sites across = f.objective.project(f.moved, f.state.sites.faces);
  const Sites found = limit.project(f.state, f.moved, f.state.sites.faces);
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_NEAR((across.positions[k] - points[k]).norm(), stripe, 1e-12) << k;
    EXPECT_LE((found.positions[k] - points[k]).norm(), reach) << k;
  }
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
