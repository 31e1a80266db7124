// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/neighbors.hpp>
#include <dapple/projector.hpp>
#include <dapple/sampler.hpp>

#include "shapes.hpp"
#include "track/frame_solver.hpp"
#include "track/move_apart.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 400;
constexpr double kApart = 0.02;  // about half the spacing of so many samples on a unit square

/// Even sites of a square, the first of which are moved to one place.
Sites with_crowd(const Surface& surface, std::size_t crowded) {
  Sites sites = sites_of(sample(surface, kCount));
  std::vector<Vec3> points(crowded, Vec3(0.4, 0.6, 0.0));
  for (std::size_t k = 2; k < crowded; ++k) points[k].x() += 1e-4 * static_cast<double>(k);
  const Projection found = Projector(surface).project(points);
  for (std::size_t k = 0; k < crowded; ++k) {
    sites.positions[k] = found.positions[k];
    sites.faces[k] = found.faces[k];
    sites.barycentric[k] = found.barycentric[k];
  }
  return sites;
}

Sites moved(const Surface& surface, Sites sites) {
  move_apart(SurfaceDomain(surface), std::vector<double>(kCount, 0.5 * kApart), sites, nullptr);
  return sites;
}

TEST(MoveApart, SeparatesSitesAtOnePlace) {
  const Surface surface = grid(20).surface();
  const Sites sites = moved(surface, with_crowd(surface, 6));
  EXPECT_GE(std::ranges::min(nearest_distances(sites.positions)), 0.95 * kApart);
  for (std::size_t k = 0; k < kCount; ++k)
    EXPECT_LT((surface.point(sites.faces[k], sites.barycentric[k]) - sites.positions[k]).norm(),
              1e-12);
}

TEST(MoveApart, LeavesSitesThatAreNotInTheWay) {
  const Surface surface = grid(20).surface();
  const Sites before = with_crowd(surface, 6), after = moved(surface, before);
  for (std::size_t k = 0; k < kCount; ++k) {
    if ((before.positions[k] - Vec3(0.4, 0.6, 0.0)).norm() > 8.0 * kApart) {
      EXPECT_EQ(after.positions[k], before.positions[k]) << k;
    }
  }
}

TEST(MoveApart, LeavesEvenSites) {
  const Surface surface = grid(20).surface();
  const Sites before = with_crowd(surface, 0);
  EXPECT_EQ(moved(surface, before).positions, before.positions);
}

TEST(MoveApart, LeavesTheOtherSideOfASheet) {
  const Surface surface = box(8).surface();
  const SurfaceDomain domain(surface);
  const Projection found =
      Projector(surface).project(std::vector<Vec3>{{0.5, 0.5, 0.0}, {0.5, 0.5, 1.0}});
  Sites sites{found.positions, found.faces, found.barycentric};
  move_apart(domain, std::vector<double>(2, 1.0), sites, nullptr);
  EXPECT_EQ(sites.positions, found.positions);
}

}  // namespace
}  // namespace dapple::test
