// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/poisson_start.hpp>

#include "shapes.hpp"
#include "voronoi/near_sites.hpp"
#include "voronoi/site_index.hpp"

namespace dapple::test {
namespace {

/// All other sites, ordered by distance.
std::vector<Rival> others(const OrderedSites& sites, std::int32_t site) {
  std::vector<Rival> result;
  for (std::int32_t other = 0; other < static_cast<std::int32_t>(sites.size()); ++other)
    if (other != site)
      result.push_back({(sites.position(other) - sites.position(site)).squaredNorm(),
                        sites.original(other), other});
  std::sort(result.begin(), result.end());
  return result;
}

/// Check that the sites found so far are the nearest ones.
void expect_nearest(std::span<const Rival> found, const std::vector<Rival>& all) {
  ASSERT_LE(found.size(), all.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].site, all[k].site);
}

/// A dense group of sites on large faces, and a steep density, give neighborhoods of all sizes.
class NearSitesOn : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, NearSitesOn,
                         testing::Values(box(1), blob(3),
                                         with_face_density(icosphere(4), [](const Vec3& x) {
                                           return std::exp(8.0 * x.z());
                                         })));

TEST(NearSites, AreInTheCallersOrderAtEqualDistances) {
  const Surface surface = grid(16).surface();
  Sites sites;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f) {
    sites.faces.push_back(f);
    sites.positions.push_back(surface.point(f, Vec3(0.5, 0.25, 0.25)));
  }
  const OrderedSites ordered(surface, sites);
  const SiteIndex index(ordered);
  NearSites near(index, surface.spacing(ordered.size()));
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(ordered.size()); ++site) {
    near.turn_to(site);
    expect_nearest(near.all(), others(ordered, site));
  }
}

TEST_P(NearSitesOn, AreTheNearestHoweverFarOneReaches) {
  const Surface surface = GetParam().surface();
  const OrderedSites sites(surface, poisson_start(surface, 500, 3));
  const SiteIndex index(sites);
  NearSites near(index, surface.spacing(sites.size()));
  for (std::int32_t site = 0; site < 500; ++site) {
    const std::vector<Rival> all = others(sites, site);
    near.turn_to(site);
    near.note_need(all[static_cast<std::size_t>(site) % 20].squared_distance);
    expect_nearest(near.all(), all);
    for (int k = 0; k < site % 3; ++k) near.extend();
    expect_nearest(near.all(), all);
  }
}

/// The search starts with about as many sites as earlier cells needed.
TEST_P(NearSitesOn, AreFewMoreThanNeeded) {
  constexpr std::size_t kNeeded = 20, kSites = 2000;
  const Surface surface = GetParam().surface();
  const OrderedSites sites(surface, poisson_start(surface, kSites, 3));
  const SiteIndex index(sites);
  NearSites near(index, surface.spacing(sites.size()));
  std::size_t found = 0, extended = 0;
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(kSites); ++site) {
    near.turn_to(site);
    for (; near.all().size() < kNeeded; ++extended) near.extend();
    near.note_need(near.all()[kNeeded - 1].squared_distance);
    found += near.all().size();
  }
  EXPECT_LT(found, 4 * kNeeded * kSites);
  EXPECT_LT(extended, kSites / 4);
}

TEST_P(NearSitesOn, FindAllSitesEventually) {
  constexpr std::size_t kSites = NearSites<SiteIndex>::kMost;
  const Surface surface = GetParam().surface();
  const OrderedSites sites(surface, poisson_start(surface, kSites, 3));
  const SiteIndex index(sites);
  NearSites near(index, surface.spacing(sites.size()));
  near.turn_to(25);
  std::size_t before = near.all().size();
  while (!near.is_complete()) {
    near.extend();
    EXPECT_GE(near.all().size(), before);
    before = near.all().size();
  }
  EXPECT_EQ(before, kSites - 1);
}

/// A body and small far components, each with a site numbered among those of the body.
struct Scattered {
  Surface surface;
  OrderedSites sites;
};

Scattered with_far_specks() {
  Shape shape = icosphere(4);
  for (int k = 0; k < 20; ++k)
    shape = joined(shape, mapped(tetrahedron(), [&](const Vec3& x) {
                     return Vec3(0.001 * x + Vec3(1000.0 * (k + 1), 7.0 * k, 0));
                   }));
  const Surface surface = shape.surface();
  Sites sites = poisson_start(icosphere(4).surface(), 2000, 3);
  for (std::size_t k = 0; k < 20; ++k) {
    sites.faces.push_back(static_cast<std::int32_t>(icosphere(4).faces.size() + 4 * k));
    sites.positions.push_back(
        shape.point(static_cast<std::size_t>(sites.faces.back()), Vec3::Constant(1.0 / 3.0)));
    sites.barycentric.push_back(Vec3::Constant(1.0 / 3.0));
  }
  return {surface, OrderedSites(surface, sites)};
}

/// An isolated site searches far; the sites after it do not.
TEST(NearSites, DoNotInheritALargeReach) {
  const Scattered all = with_far_specks();
  const SiteIndex index(all.sites);
  NearSites near(index, all.surface.spacing(all.sites.size()));
  std::size_t within = 0;
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(all.sites.size()); ++site) {
    near.turn_to(site);
    const bool alone = site % 8 == 3;
    within += alone ? 0 : near.within_reach();
    near.note_need(alone ? 1e6 : 0.02);
  }
  EXPECT_LT(within, 40 * all.sites.size());
}

/// An isolated site finds any number of neighbors in a few steps.
TEST(NearSites, OfAnIsolatedSiteAreFoundInFewSteps) {
  const Scattered all = with_far_specks();
  const SiteIndex index(all.sites);
  NearSites near(index, all.surface.spacing(all.sites.size()));
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(all.sites.size()); ++site) {
    if (all.sites.position(site).norm() < 2.0) continue;
    near.turn_to(site);
    int steps = 0;
    for (; near.all().size() < NearSites<SiteIndex>::kMost; ++steps) near.extend();
    EXPECT_LE(steps, 4);
    EXPECT_LE(near.within_reach(), NearSites<SiteIndex>::kMost + 1);
    expect_nearest(near.all(), others(all.sites, site));
  }
}

}  // namespace
}  // namespace dapple::test
