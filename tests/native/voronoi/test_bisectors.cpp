// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/poisson_start.hpp>

#include "shapes.hpp"
#include "voronoi/bisectors.hpp"

namespace dapple::test {
namespace {

/// All sites on a tenth of a sphere: the cells at its rim reach around to the other side, and yet a
/// list of some dozens has all that cut them.
TEST(Bisectors, OfACellThatGoesFarAreFew) {
  const Shape shape = with_face_density(icosphere(4), [](const Vec3& x) { return x.z() > 0.8; });
  const Surface surface = shape.surface();
  const OrderedSites sites(surface, poisson_start(surface, 2000, 1));
  const SiteIndex index(sites, nullptr);
  Bisectors bisectors(surface, sites, index);
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(sites.size()); ++site) {
    bisectors.reset(site);
    std::size_t count = 0;
    while (bisectors.at(count)) ++count;
    EXPECT_LT(count, 100u) << "site " << site;
  }
}

}  // namespace
}  // namespace dapple::test
