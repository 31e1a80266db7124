// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/sampler.hpp>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "track/frame_solver.hpp"
#include "track/turnover.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 1000;

/// Samples of a square, with those of its left third moved into its middle third.
Transferred crowded(const Surface& surface) {
  Transferred there{{}, dapple::sites_of(sample(surface, kCount))};
  there.which.resize(kCount);
  std::iota(there.which.begin(), there.which.end(), 0);
  for (Vec3& p : there.sites.positions)
    if (p.x() < 1.0 / 3.0) p.x() = 2.0 / 3.0 - p.x();
  const Projection found = Projector(surface).project(there.sites.positions);
  there.sites = {found.positions, found.faces, found.barycentric};
  return there;
}

struct Change {
  std::size_t births, deaths;
};

Change change_of(const Turnover& turnover) {
  const auto births =
      static_cast<std::size_t>(std::count(turnover.origin.begin(), turnover.origin.end(), -1));
  return {births, kCount - (turnover.origin.size() - births)};
}

Turnover turned_over(const Surface& surface, const Transferred& there, std::size_t count) {
  return turn_over(surface, SurfaceDomain(surface), there, kCount, count, 0, nullptr);
}

TEST(Turnover, ChangesAtMostFivePerThousand) {
  const Surface surface = grid(20).surface();
  const Transferred there = crowded(surface);
  const auto [births, deaths] = change_of(turned_over(surface, there, kCount));
  EXPECT_EQ(births, 2u);
  EXPECT_EQ(deaths, 2u);
}

TEST(Turnover, InsertsSamplesInGaps) {
  const Surface surface = grid(20).surface();
  const Transferred there = crowded(surface);
  const Turnover found = turned_over(surface, there, kCount + 100);
  EXPECT_EQ(found.sites.size(), kCount + 100);
  const auto [births, deaths] = change_of(found);
  EXPECT_LE(births + deaths, 105u);
  for (std::size_t k = 0; k < found.sites.size(); ++k) {
    if (found.origin[k] < 0) {
      EXPECT_LT(found.sites.positions[k].x(), 0.4);
    }
  }
}

TEST(Turnover, RemovesSamplesFromDenseRegions) {
  const Surface surface = grid(20).surface();
  const Transferred there = crowded(surface);
  const Turnover found = turned_over(surface, there, kCount - 100);
  const auto [births, deaths] = change_of(found);
  EXPECT_LE(births + deaths, 105u);
  std::vector<bool> stays(kCount, false);
  for (const std::int32_t o : found.origin)
    if (o >= 0) stays[static_cast<std::size_t>(o)] = true;
  for (std::size_t k = 0; k < kCount; ++k)
    if (!stays[k]) {
      EXPECT_GT(there.sites.positions[k].x(), 0.3);
      EXPECT_LT(there.sites.positions[k].x(), 0.7);
    }
}

TEST(Turnover, LeavesEvenSamplesAlone) {
  const Surface surface = blob(4).surface();
  Transferred there{{}, dapple::sites_of(sample(surface, kCount))};
  there.which.resize(kCount);
  std::iota(there.which.begin(), there.which.end(), 0);
  const Turnover found = turned_over(surface, there, kCount);
  EXPECT_EQ(found.origin, there.which);
  EXPECT_TRUE(same_bytes(found.sites.positions, there.sites.positions));
}

TEST(Turnover, RestartsFromNoSamples) {
  const Surface surface = grid(4).surface();
  EXPECT_EQ(change_of(turned_over(surface, {}, 50)).births, 50u);
  EXPECT_TRUE(turned_over(surface, crowded(surface), 0).origin.empty());
}

}  // namespace
}  // namespace dapple::test
