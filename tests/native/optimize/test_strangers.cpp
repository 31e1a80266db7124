// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "optimize/strangers.hpp"

namespace dapple::test {
namespace {

/// Two walls that face each other at a distance of 0.3, as two bodies: a unit square at x = 0 and
/// one at x = 0.3.
Surface walls(bool facing, bool one_body = false) {
  const std::vector<Vec3> vertices = {{0, 0, 0},   {0, 1, 0},   {0, 1, 1},   {0, 0, 1},
                                      {0.3, 0, 0}, {0.3, 1, 0}, {0.3, 1, 1}, {0.3, 0, 1}};
  std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  if (!facing)
    for (Face& face : faces) std::swap(face[1], face[2]);
  const std::vector<std::int32_t> edges = {0, 1, 2, 2, 3, 4, 5, 6, 7, 8, 9, 5},
                                  places = {0, 1, 2, 3, 4, 5, 6, 7}, bodies = {0, 0, 1, 1};
  return {vertices, faces, Density{},
          Joints{edges, places, one_body ? std::span<const std::int32_t>() : bodies}};
}

std::vector<Stranger> found_on(const Surface& surface) {
  const SurfaceDomain domain(surface);
  const Sites sites =
      domain.project(std::vector<Vec3>{{0, 0.7, 0.2}, {0.3, 0.8, 0.3}, {0, 0.2, 0.7}}, {});
  const std::vector<double> spacings(3, 0.5);
  return find_strangers(domain, sites, domain.cells(sites, nullptr), spacings);
}

TEST(Strangers, StandOnWallsThatFaceEachOther) {
  const std::vector<Stranger> found = found_on(walls(true));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].i, 0);
  EXPECT_EQ(found[0].j, 1);
  EXPECT_NEAR((found[0].offset - Vec3(-0.3, -0.1, -0.1)).norm(), 0.0, 1e-12);
}

TEST(Strangers, DoNotStandOnTheTwoSidesOfAPlate) { EXPECT_TRUE(found_on(walls(false)).empty()); }

TEST(Strangers, AreNoneOnOneBody) { EXPECT_TRUE(found_on(walls(true, true)).empty()); }

}  // namespace
}  // namespace dapple::test
