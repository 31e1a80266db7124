// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/neighbors.hpp>
#include <dapple/sampler.hpp>

#include "invariants.hpp"
#include "rebalance/widest_gaps.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

TEST(WidestGaps, FillTheEmptyHalfApart) {
  const Surface surface = icosphere(4).surface();
  const Samples samples = sample(surface, 400);
  Gaps gaps{{}, {}, surface.capacity() / 400.0};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples.positions[k].z() > 0.0) continue;
    gaps.sites.positions.push_back(samples.positions[k]);
    gaps.sites.faces.push_back(samples.faces[k]);
    gaps.sites.barycentric.push_back(samples.barycentric[k]);
    gaps.open.push_back(true);
  }
  const std::size_t missing = 400 - gaps.sites.size();
  const Sites found = widest_gaps(surface, gaps, missing, 1, nullptr);
  ASSERT_EQ(found.size(), missing);
  check_on_surface(surface, found, found.barycentric);
  std::vector<Vec3> all = gaps.sites.positions;
  all.insert(all.end(), found.positions.begin(), found.positions.end());
  const std::vector<double> distances = nearest_distances(all);
  EXPECT_GT(*std::min_element(distances.begin(), distances.end()), 0.5 * surface.spacing(400));
  const auto elsewhere =
      std::count_if(found.positions.begin(), found.positions.end(),
                    [&](const Vec3& x) { return x.z() < -0.5 * surface.spacing(400); });
  EXPECT_LT(elsewhere, 20) << "the last ones go where gaps are hardly wider";
}

TEST(WidestGaps, AreInOpenCells) {
  const Surface surface = icosphere(3).surface();
  const Samples samples = sample(surface, 60);
  Gaps gaps{{samples.positions, samples.faces, samples.barycentric},
            std::vector<bool>(60, false),
            surface.capacity() / 60.0};
  EXPECT_EQ(widest_gaps(surface, gaps, 5, 1, nullptr).size(), 0u);
  gaps.open[7] = true;
  const Sites found = widest_gaps(surface, gaps, 3, 1, nullptr);
  EXPECT_GT(found.size(), 0u);
  const Neighbors tree(samples.positions);
  std::vector<Neighbor> near;
  for (const Vec3& x : found.positions) {
    tree.nearest(x, 1, near);
    EXPECT_EQ(near[0].index, 7);
  }
}

TEST(WidestGaps, HaveTheRequestedCountInFewOpenCells) {
  const Surface surface = icosphere(4).surface();
  const Samples samples = sample(surface, 400);
  Gaps gaps{{samples.positions, samples.faces, samples.barycentric},
            std::vector<bool>(400, false),
            surface.capacity() / 400.0};
  gaps.open[100] = true;
  EXPECT_EQ(widest_gaps(surface, gaps, 40, 1, nullptr).size(), 40u);
}

}  // namespace
}  // namespace dapple::test
