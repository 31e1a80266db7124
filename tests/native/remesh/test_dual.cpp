// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "remesh/dual.hpp"

namespace dapple::test {
namespace {

/// Two triangles beside the edge from 0 to 2, and two more beside it elsewhere.
const std::vector<Face> kTwice = {{0, 1, 2}, {0, 2, 3}, {0, 4, 2}, {2, 5, 0}};

const std::vector<Vec3> kSites(6, Vec3::Zero());

std::vector<Place> places() {
  std::vector<Place> result(kTwice.size());
  for (std::size_t k = 2; k < result.size(); ++k) result[k].position = Vec3::UnitX();
  return result;
}

TEST(Dual, EdgesThatRunTwiceAreMendedWhereCellsMeetFartherAway) {
  std::vector<Violation> violations;
  find_repeated_edges(kTwice, places(), kSites, std::vector<SiteKind>(6, SiteKind::kFree),
                      violations);
  ASSERT_EQ(violations.size(), 2u);  // one for each direction
  for (const Violation& violation : violations) {
    EXPECT_EQ(violation.flaw, Flaw::kMetTwice);
    EXPECT_EQ(violation.place.position, Vec3(Vec3::UnitX()));
  }
}

TEST(Dual, EdgesMayRunTwiceAlongLines) {
  std::vector<Violation> violations;
  find_repeated_edges(kTwice, places(), kSites, std::vector<SiteKind>(6, SiteKind::kLine),
                      violations);
  EXPECT_TRUE(violations.empty());
}

}  // namespace
}  // namespace dapple::test
