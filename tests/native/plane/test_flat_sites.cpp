// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.hpp"
#include "plane/flat_sites.hpp"
#include "voronoi/near_sites.hpp"

namespace dapple::test {
namespace {

constexpr double kSpacing = 0.05;

std::vector<Vec3> random_points(std::size_t count, double size) {
  Random random(3);
  std::vector<Vec3> points;
  while (points.size() < count) {
    const double x = size * random.uniform();
    points.emplace_back(x, size * random.uniform(), 0.0);
  }
  return points;
}

/// All images but that of the place itself, the nearest first.
std::vector<Rival> others(const FlatSites& sites, std::int32_t place) {
  std::vector<Rival> result;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(sites.population()); ++k)
    if (k != place)
      result.push_back(
          {(sites.position(k) - sites.position(place)).squaredNorm(), sites.original(k), k});
  std::sort(result.begin(), result.end());
  return result;
}

void expect_nearest(std::span<const Rival> found, const std::vector<Rival>& all) {
  ASSERT_LE(found.size(), all.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].site, all[k].site);
}

/// In the plane, and on the torus.
class FlatSitesOn : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Domains, FlatSitesOn, testing::Bool());

TEST_P(FlatSitesOn, AreTheNearestHoweverFarOneReaches) {
  const FlatSites sites(random_points(300, 1.0), GetParam());
  NearSites near(sites, kSpacing);
  for (std::int32_t place = 0; place < 300; ++place) {
    const std::vector<Rival> all = others(sites, place);
    near.turn_to(place);
    near.note_need(all[static_cast<std::size_t>(place) % 20].squared_distance);
    expect_nearest(near.all(), all);
    for (int k = 0; k < place % 4; ++k) near.extend();
    expect_nearest(near.all(), all);
  }
}

/// At equal distances the order is that of the sites, then of the images' coordinates.
TEST(FlatSites, OfALatticeAreInTheCallersOrder) {
  std::vector<Vec3> points;
  for (int k = 0; k < 16; ++k) points.emplace_back(0.25 * (k % 4), 0.25 * (k / 4), 0.0);
  const FlatSites sites(points, true);
  NearSites near(sites, 0.25);
  for (std::int32_t place = 0; place < 16; ++place) {
    near.turn_to(place);
    near.extend();
    expect_nearest(near.all(), others(sites, place));
    for (std::size_t k = 1; k < near.all().size(); ++k) {
      const Rival &before = near.all()[k - 1], &now = near.all()[k];
      if (before.squared_distance < now.squared_distance) continue;
      const auto order = [&](const Rival& one) {
        const Vec3 x = sites.position(one.site);
        return std::tuple(sites.site(one.site), x.x(), x.y());
      };
      EXPECT_LT(order(before), order(now));
    }
  }
}

/// A far site needs a large reach; those after it do not inherit it.
TEST(FlatSites, DoNotInheritTheReachOfAFarSite) {
  std::vector<Vec3> points = random_points(2000, 1.0);
  for (int k = 0; k < 20; ++k) points.emplace_back(1000.0 * (k + 1), 7.0 * k, 0.0);
  const FlatSites sites(points, false);
  NearSites near(sites, kSpacing);
  std::size_t within = 0;
  for (std::int32_t place = 0; place < static_cast<std::int32_t>(sites.size()); ++place) {
    near.turn_to(place);
    const bool alone = place % 8 == 3;
    within += alone ? 0 : near.within_reach();
    near.note_need(alone ? 1e6 : 0.005);
  }
  EXPECT_LT(within, 40 * sites.size());
}

}  // namespace
}  // namespace dapple::test
