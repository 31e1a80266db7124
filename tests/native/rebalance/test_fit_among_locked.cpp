// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/poisson_start.hpp>

#include "rebalance/fit_among_locked.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

struct Given {
  Surface surface = grid(12).surface();
  SurfaceDomain domain{surface, Cells::kConnected};
  Sites sites = poisson_start(surface, 400, 1);
  std::vector<bool> locked = std::vector<bool>(400, false);
};

TEST(FitAmongLocked, HasTheCountAndAllLockedSites) {
  Given given;
  std::fill_n(given.locked.begin(), 50, true);
  for (const std::size_t count : {50u, 200u, 400u, 900u}) {
    const FittedSites fitted =
        fit_among_locked(given.surface, given.domain, given.sites, given.locked, count, 1, nullptr);
    EXPECT_EQ(fitted.stay.size() + fitted.fresh.size(), count);
    EXPECT_TRUE(std::ranges::is_sorted(fitted.stay));
    for (std::size_t k = 0; k < 50; ++k) EXPECT_TRUE(std::ranges::count(fitted.stay, k) == 1);
  }
}

TEST(FitAmongLocked, FillsTheSideThatLacksSites) {
  Given given;
  Sites left;  // half of the surface has none
  for (std::size_t k = 0; k < given.sites.size(); ++k) {
    if (given.sites.positions[k].x() > 0.5) continue;
    left.positions.push_back(given.sites.positions[k]);
    left.faces.push_back(given.sites.faces[k]);
    left.barycentric.push_back(given.sites.barycentric[k]);
  }
  std::vector<bool> locked(left.size(), false);
  std::fill_n(locked.begin(), 10, true);
  const FittedSites fitted =
      fit_among_locked(given.surface, given.domain, left, locked, 2 * left.size(), 1, nullptr);
  const auto far =
      std::ranges::count_if(fitted.fresh.positions, [](const Vec3& p) { return p.x() > 0.5; });
  EXPECT_GT(static_cast<double>(far), 0.85 * static_cast<double>(fitted.fresh.size()));
}

TEST(FitAmongLocked, CanBeCancelled) {
  Given given;
  given.locked[0] = true;
  Context context;
  context.cancel();
  EXPECT_THROW((void)fit_among_locked(given.surface, given.domain, given.sites, given.locked, 300,
                                      1, &context),
               Cancelled);
}

}  // namespace
}  // namespace dapple::test
