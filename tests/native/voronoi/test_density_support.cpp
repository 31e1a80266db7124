// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "shapes.hpp"
#include "surface/on_density.hpp"
#include "voronoi/density_support.hpp"

namespace dapple::test {
namespace {

constexpr int kCells = 100;

/// The unit square with density 1 where `has(x, y)` holds at the middle of a face.
template <typename Has>
Surface square(const Has& has) {
  const Surface whole = grid(kCells).surface();
  const std::vector<Vec3> vertices = whole.vertices();
  std::vector<double> density;
  for (const auto& [a, b, c] : whole.faces()) {
    const Vec3 x = (vertices[a] + vertices[b] + vertices[c]) / 3;
    density.push_back(has(x.x(), x.y()) ? 1.0 : 0.0);
  }
  return whole.with_density({DensityAt::kFaces, density});
}

DensitySupport support_of(const Surface& surface, std::size_t count) {
  return {surface, *face_edges_of(surface.ordered()), count};
}

double middle_of(const Surface& surface, OrderedFace face) {
  return surface.ordered().geometry(face).centroid.x();
}

TEST(HasGaps, IsFalseWhereAllFacesHaveDensity) {
  EXPECT_FALSE(has_gaps(grid(3).surface()));
  EXPECT_FALSE(has_gaps(square([](double, double) { return true; })));
  EXPECT_TRUE(has_gaps(square([](double x, double) { return x < 0.5; })));
}

TEST(DensitySupport, EndsNearDensity) {
  const Surface surface = square([](double x, double) { return x < 0.5; });
  const std::size_t count = 200;  // a spacing of 0.054, of which 0.4 count
  const DensitySupport support = support_of(surface, count);
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const double x = middle_of(surface, nth_face(f));
    if (x > 0.51 && x < 0.54) continue;
    EXPECT_EQ(support.has(nth_face(f)), x < 0.51) << x;
  }
}

TEST(DensitySupport, HasPartsThatWideGapsSeparate) {
  const auto stripes = [](double x, double) { return x < 0.2 || (x > 0.22 && x < 0.4) || x > 0.7; };
  const Surface surface = square(stripes);
  const auto edges = face_edges_of(surface.ordered());
  const DensitySupport support(surface, *edges, 200);
  EXPECT_EQ(support.part_count(), 2U);
  std::array<std::int32_t, 3> parts = {-1, -1, -1};
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const std::int32_t part = support.part(edges->corners()[f][0]);
    const double x = middle_of(surface, nth_face(f));
    if (x < 0.4) parts[0] = part;
    if (x > 0.5 && x < 0.6) parts[1] = part;
    if (x > 0.7) parts[2] = part;
  }
  EXPECT_EQ(parts[1], -1);
  EXPECT_NE(parts[0], -1);
  EXPECT_NE(parts[2], -1);
  EXPECT_NE(parts[0], parts[2]);
}

/// So many sites that only faces beside density count: those of two squares meet at a corner.
TEST(DensitySupport, NamesVerticesWhereFacesAreNotConnectedAround) {
  const auto checks = [](double x, double y) {
    return (x < 0.49 && y < 0.49) || (x > 0.51 && y > 0.51);
  };
  const Surface surface = square(checks);
  const DensitySupport support = support_of(surface, 10'000'000);
  ASSERT_EQ(support.part_count(), 1U);
  const auto middle = [&](std::int32_t v) {
    return (surface.ordered().vertex(v) - Vec3(0.5, 0.5, 0.0)).norm() < 1e-9;
  };
  EXPECT_TRUE(std::any_of(support.pinched().begin(), support.pinched().end(), middle));
}

}  // namespace
}  // namespace dapple::test
