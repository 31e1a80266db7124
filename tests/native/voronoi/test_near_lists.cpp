// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/poisson_start.hpp>

#include "shapes.hpp"
#include "voronoi/near_lists.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kSites = 400;

/// Lists of sites that move.
class MovingLists {
 public:
  MovingLists(const Surface& surface, const Sites& sites)
      : surface_(surface),
        ordered_(surface, sites),
        index_(ordered_),
        lists_(surface, ordered_, index_) {
    lists_.make(/*by_component=*/false);
  }

  void move_to(const Sites& sites) {
    ASSERT_TRUE(lists_.hold_for(sites, /*by_component=*/false));
    ordered_.move(surface_, sites);
    index_.refit();
    lists_.move();
  }

  [[nodiscard]] const NearLists& lists() const { return lists_; }
  [[nodiscard]] NearLists& lists() { return lists_; }

  /// By comparing all; at equal distances the first in the caller's order.
  [[nodiscard]] std::int32_t nearest(const Triple& point, std::int32_t i = -1,
                                     std::int32_t j = -1) const {
    std::int32_t best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (std::int32_t site = 0; site < static_cast<std::int32_t>(ordered_.size()); ++site) {
      const double squared = lists_.squared_distance(site, point);
      if (site == i || site == j || squared > least) continue;
      if (squared == least && ordered_.original(best) < ordered_.original(site)) continue;
      best = site;
      least = squared;
    }
    return best;
  }

 private:
  const Surface& surface_;
  OrderedSites ordered_;
  SiteIndex index_;
  NearLists lists_;
};

Sites moved(const Surface& surface, Sites sites, double spacings, Random& random) {
  const double step = spacings * surface.spacing(sites.size());
  for (Vec3& x : sites.positions) x += step * random.in_box().normalized();
  return sites;
}

Triple point_near(const Surface& surface, Random& random) {
  const Vec3 x = surface.point(random.below(static_cast<std::int32_t>(surface.face_count())),
                               random.weights());
  return Triple(x + 0.02 * random.in_box());
}

/// Sparse and dense parts, and lattices with many equal distances.
class NearListsOn : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, NearListsOn,
                         testing::Values(box(4), blob(3),
                                         with_face_density(icosphere(4),
                                                           [](const Vec3& x) {
                                                             return std::exp(6.0 * x.z());
                                                           })),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(NearListsOn, FindTheNearestSiteHoweverOldTheyAre) {
  const Surface surface = GetParam().surface();
  Random random(1);
  const Sites sites = poisson_start(surface, kSites, 3);
  MovingLists moving(surface, sites);
  for (int age = 0; age < 4; ++age) {
    for (int k = 0; k < 300; ++k) {
      const Triple point = point_near(surface, random);
      const std::int32_t from = random.below(static_cast<std::int32_t>(kSites));
      const std::int32_t expected = moving.nearest(point);
      EXPECT_EQ(moving.lists().nearest(point, from).site, expected);
      EXPECT_EQ(moving.lists().search(point, from).site, expected);
    }
    moving.move_to(moved(surface, sites, 0.02, random));
  }
}

TEST_P(NearListsOn, FindAThirdSiteNearACut) {
  const Surface surface = GetParam().surface();
  Random random(2);
  const Sites sites = poisson_start(surface, kSites, 3);
  MovingLists moving(surface, sites);
  moving.move_to(moved(surface, sites, 0.02, random));
  for (int k = 0; k < 300; ++k) {
    const Triple point = point_near(surface, random);
    const std::int32_t i = moving.nearest(point), j = moving.nearest(point, i);
    const double squared = moving.lists().squared_distance(j, point);
    EXPECT_EQ(moving.lists().nearer(point, squared, i, j), -1);
    EXPECT_EQ(moving.lists().nearer(point, squared, j, -1), i);
    const std::int32_t third = moving.nearest(point, i, j);
    EXPECT_EQ(
        moving.lists().nearer(point, 4.0 * moving.lists().squared_distance(third, point), i, j),
        third);
  }
}

/// Along a line from the nearest site's cell, the exit leads to the next nearest site.
TEST_P(NearListsOn, LeaveACellThroughTheFirstBisector) {
  const Surface surface = GetParam().surface();
  Random random(3);
  const MovingLists made(surface, poisson_start(surface, kSites, 3));
  for (int k = 0; k < 200; ++k) {
    const Triple a = point_near(surface, random), b = point_near(surface, random), along = b - a;
    const std::int32_t site = made.nearest(a);
    const NearLists::Exit exit = made.lists().exit(site, a, along, 0.0, 1.0, -1);
    if (exit.site < 0) {
      EXPECT_EQ(made.nearest(b), site);
      continue;
    }
    EXPECT_EQ(made.nearest(a + (exit.t - 1e-7) * along), site);
    EXPECT_NE(made.nearest(a + (exit.t + 1e-7) * along), site);
  }
}

TEST(NearLists, AreMadeAnewForSitesThatMoveFar) {
  const Surface surface = blob(3).surface();
  Random random(4);
  const Sites sites = poisson_start(surface, kSites, 3);
  MovingLists moving(surface, sites);
  EXPECT_TRUE(moving.lists().hold_for(moved(surface, sites, 0.05, random), false));
  EXPECT_FALSE(moving.lists().hold_for(moved(surface, sites, 0.5, random), false));
  EXPECT_FALSE(moving.lists().hold_for(poisson_start(surface, kSites + 1, 3), false));
}

TEST(NearLists, NameTheFirstOfSitesAtOnePlace) {
  const Surface surface = grid(4).surface();
  const Vec3 a = surface.point(3, Vec3(0.2, 0.3, 0.5)), b = surface.point(9, Vec3(0.2, 0.3, 0.5));
  const Sites sites{{b, a, a, b}, {9, 3, 3, 9}};
  const OrderedSites ordered(surface, sites);
  const SiteIndex index(ordered);
  NearLists lists(surface, ordered, index);
  lists.make(false);
  for (std::int32_t site = 0; site < 4; ++site)
    EXPECT_EQ(ordered.original(lists.leader(site)), ordered.original(site) % 3 == 0 ? 0 : 1);
  EXPECT_FALSE(lists.hold_for(sites, false));  // sites at one place may part
}

}  // namespace
}  // namespace dapple::test
