// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/curvature.hpp>
#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/projector.hpp>
#include <dapple/refine.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <dapple/tracker.hpp>
#include <limits>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

Surface by_index(const Shape& shape) {
  return {shape.vertices, shape.faces, {shape.density_at, shape.density}, {.weld = std::nullopt}};
}

Surface within(const Shape& shape, double weld) {
  return {shape.vertices, shape.faces, {shape.density_at, shape.density}, {.weld = weld}};
}

Shape moved(const Shape& shape, const Vec3& by) {
  return mapped(shape, [by](const Vec3& p) { return Vec3(p + by); });
}

/// A shape before and after its vertices were split.
struct Split {
  Shape whole;
  Shape split;
};

std::vector<Split> split_shapes() {
  std::vector<Split> result;
  const Shape dense = with_density(blob(3), [](const Vec3& p) { return 1.2 + p.x(); });
  for (const Shape& shape : {box(4), blob(3), torus(20, 12), grid(6), tube(12, 5), fin(4), tee(3),
                             moebius(24), two_sheets(5, 0.03), flipped_faces(), dense}) {
    result.push_back({shape, soup(shape)});
    result.push_back({shape, split_edges(shape, 30.0)});
  }
  return result;
}

TEST(Weld, EndsNearTheLargestNumber) {
  constexpr double most = std::numeric_limits<double>::max();
  const Shape far{"Far", {{-most, 0, 0}, {-most, 1, 0}, {-most + 1e300, 0, 1}}, {{0, 1, 2}}};
  EXPECT_THROW((void)far.surface(), SurfaceError);
}

TEST(Weld, WeldsAllVerticesWithinAnInfiniteTolerance) {
  for (const double weld : {2.0, 1e300, std::numeric_limits<double>::max()})
    EXPECT_EQ(within(soup(grid(2)), weld).welded_faces(),
              within(soup(grid(2)), 10.0).welded_faces())
        << weld;
}

TEST(Weld, SplitVerticesAreNoBorders) {
  for (const auto& [whole, split] : split_shapes()) {
    const Topology expected = topology(whole.surface());
    const Topology found = topology(split.surface());
    EXPECT_EQ(found.components, expected.components) << split.name;
    EXPECT_EQ(found.border_edges, expected.border_edges) << split.name;
    EXPECT_EQ(found.border_loops, expected.border_loops) << split.name;
    EXPECT_EQ(found.nonmanifold_edges, expected.nonmanifold_edges) << split.name;
    EXPECT_EQ(found.manifold, expected.manifold) << split.name;
    EXPECT_EQ(found.genus, expected.genus) << split.name;
  }
}

TEST(Weld, VerticesKeepTheirIndices) {
  const Shape shape = soup(box(2));
  const Surface surface = shape.surface();
  EXPECT_EQ(surface.faces(), shape.faces);
  EXPECT_EQ(surface.vertices(), shape.vertices);
  EXPECT_EQ(surface.welded_faces().size(), shape.faces.size());
}

TEST(Weld, SamplesOfSplitVerticesAreThoseOfTheWholeMesh) {
  for (const auto& [whole, split] : split_shapes()) {
    SampleOptions options;
    options.optimizer.max_evaluations = 12;
    const Samples expected = sample(whole.surface(), 150, options);
    const Samples found = sample(split.surface(), 150, options);
    EXPECT_EQ(found.positions, expected.positions) << split.name;
    EXPECT_EQ(found.faces, expected.faces) << split.name;
    EXPECT_EQ(found.report.evaluations, expected.report.evaluations) << split.name;
  }
}

/// A frame's motion is measured at the vertices. A soup has more of them, so moves are only nearly
/// the same.
TEST(Weld, TrackedSamplesOfSplitVerticesStayAsEven) {
  const Shape whole = box(6);
  Tracker expected(whole.surface(), sample(whole.surface(), 200));
  for (const Shape& split : {soup(whole), split_edges(whole, 30.0)}) {
    Tracker found(split.surface(), sample(split.surface(), 200));
    for (const double time : {0.3, 0.6, 0.9}) {
      const Report& one = expected.advance(deformed(whole.vertices, time)).report;
      const Report& other = found.advance(deformed(split.vertices, time)).report;
      EXPECT_LE(other.evenness.capacity_variation, 1.3 * one.evenness.capacity_variation);
      EXPECT_GE(other.evenness.alpha_min, one.evenness.alpha_min - 0.03);
    }
    expected = Tracker(whole.surface(), sample(whole.surface(), 200));
  }
}

TEST(Weld, TheFirstFrameDecides) {
  const Shape whole = soup(box(2));
  std::vector<Vec3> torn = whole.vertices;
  for (std::size_t v = 0; v < torn.size(); v += 3) torn[v] += Vec3(0.01, 0.02, 0.03);
  EXPECT_EQ(whole.surface().deformed(torn).ordered().components(), 1);
  EXPECT_GT(Surface(torn, whole.faces).ordered().components(), 1);
}

TEST(Weld, NoneConnectsByIndicesAlone) {
  const Shape split = soup(box(2));
  EXPECT_EQ(by_index(split).ordered().components(), static_cast<std::int32_t>(split.faces.size()));
  const Refined refined = refine_edges(by_index(split), std::array{0.3}, 100'000);
  EXPECT_EQ(refined.surface.ordered().components(), by_index(split).ordered().components());
}

/// Each face that lies on another one counts.
Surface with_doubled(const Shape& shape) {
  return {shape.vertices, shape.faces, Density{}, {.merge_doubled = false}};
}

TEST(Weld, SolidsThatTouchFaceToFaceStayApart) {
  const Shape two = joined(box(2), moved(box(2), {1, 0, 0}));
  EXPECT_EQ(with_doubled(two).ordered().components(), 2);
  EXPECT_EQ(with_doubled(soup(two)).ordered().components(), 2);
  EXPECT_EQ(with_doubled(split_edges(two, 30.0)).ordered().components(), 2);
  EXPECT_EQ(topology(with_doubled(soup(two))).border_edges, 0);
}

TEST(Weld, SolidsThatHaveOneFaceInCommonHangTogether) {
  const Shape two = joined(box(2), moved(box(2), {1, 0, 0}));
  for (const Shape& shape : {two, soup(two), split_edges(two, 30.0)}) {
    EXPECT_EQ(shape.surface().doubled_faces(), 8u);
    EXPECT_EQ(shape.surface().ordered().components(), 1);
    EXPECT_EQ(topology(shape.surface()).border_edges, 0);
  }
}

TEST(Weld, SolidsThatTouchAlongAnEdgeStayApart) {
  const Shape two = joined(box(2), moved(box(2), {1, 1, 0}));
  EXPECT_EQ(soup(two).surface().ordered().components(), 2);
}

TEST(Weld, SheetsThatLieOnEachOtherStayApart) {
  const Shape sheet = grid(4);
  Shape back = sheet;
  for (Face& face : back.faces) std::swap(face[1], face[2]);
  for (const Shape& two : {joined(sheet, sheet), joined(sheet, back)}) {
    EXPECT_EQ(with_doubled(two).ordered().components(), 2);
    EXPECT_EQ(topology(with_doubled(two)).border_edges, 32);
  }
  EXPECT_EQ(with_doubled(soup(joined(sheet, sheet))).ordered().components(), 2);
  EXPECT_EQ(with_doubled(soup(joined(blob(2), blob(2)))).ordered().components(), 2);
}

TEST(Weld, ADecalStaysApartFromTheFloorUnderIt) {
  Shape decal = moved(mapped(grid(2), [](const Vec3& p) { return Vec3(0.5 * p); }), {0.3, 0.25, 0});
  for (Face& face : decal.faces) std::rotate(face.begin(), face.begin() + 1, face.end());
  EXPECT_EQ(joined(grid(4), decal).surface().ordered().components(), 2);
}

TEST(Weld, AWallThatStandsOnAFloorIsConnected) {
  const Shape wall = mapped(grid(4), [](const Vec3& p) { return Vec3(0.5, p.x(), p.y()); });
  const Surface surface = joined(grid(4), wall).surface();
  EXPECT_EQ(surface.ordered().components(), 1);
  EXPECT_EQ(topology(surface).nonmanifold_edges, 4);
}

TEST(Weld, TheToleranceIsAShareOfTheDiagonal) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    const Shape apart = mapped(joined(grid(3), moved(grid(3), {1.0 + 1e-5, 0, 0})),
                               [size](const Vec3& p) { return Vec3(size * p); });
    EXPECT_EQ(apart.surface().ordered().components(), 2);
    EXPECT_EQ(within(apart, 1e-5).ordered().components(), 1);
  }
  EXPECT_EQ(within(soup(box(3)), 0.0).ordered().components(), 1) << "equal coordinates";
}

TEST(Weld, AToleranceBelowZeroOrNotANumberIsRefused) {
  const Shape shape = box(1);
  expect_message<SurfaceError>([&] { static_cast<void>(within(shape, -1.0)); },
                               {"weld is -1: it must be finite and >= 0"});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_message<SurfaceError>([&] { static_cast<void>(within(shape, nan)); }, {"weld is nan"});
}

TEST(Weld, FacesWithoutAreaBetweenSplitEdgesConnect) {
  const Surface surface = soup(zero_area_faces()).surface();
  EXPECT_LE(topology(surface).border_edges, 16 + 9);
  check(surface, sample(surface, 60));
}

TEST(Weld, RefinedFacesOfSplitVerticesMeet) {
  for (const auto& [whole, split] : split_shapes()) {
    const Refined expected = refine_edges(whole.surface(), std::array{0.11}, 1'000'000);
    const Refined found = refine_edges(split.surface(), std::array{0.11}, 1'000'000);
    EXPECT_EQ(found.parents, expected.parents) << split.name;
    EXPECT_EQ(found.barycentric, expected.barycentric) << split.name;
    EXPECT_EQ(found.surface.ordered().components(), expected.surface.ordered().components())
        << split.name;
    EXPECT_EQ(topology(found.surface).border_edges, topology(expected.surface).border_edges)
        << split.name;
  }
}

/// Only one face is marked; its neighbors across split edges are cut with it.
TEST(Weld, NeighborsAcrossASplitEdgeAreCutWithAFace) {
  const Shape shape = soup(box(2));
  std::vector<double> longest(shape.faces.size(), std::numeric_limits<double>::infinity());
  longest[5] = 0.1;
  const Refined refined = refine_edges(shape.surface(), longest, 100'000);
  EXPECT_EQ(topology(refined.surface).border_edges, 0);
  EXPECT_TRUE(topology(refined.surface).closed);
}

TEST(Weld, CurvatureIgnoresSplitEdges) {
  const Shape whole = blob(3), split = soup(whole);
  const std::vector<double> expected = curvedness(whole.surface());
  const std::vector<double> found = curvedness(split.surface());
  for (std::size_t c = 0; c < found.size(); ++c) {
    const auto v = static_cast<std::size_t>(whole.faces[c / 3][c % 3]);
    EXPECT_NEAR(found[c], expected[v], 1e-9 * expected[v]);
  }
}

TEST(Weld, TilesCrossSplitEdges) {
  const Shape whole = box(4), split = soup(whole);
  const Samples samples = sample(whole.surface(), 40);
  const Mosaic expected = mosaic(whole.surface(), samples);
  const Mosaic found = mosaic(split.surface(), samples);
  ASSERT_EQ(found.tiles.size(), expected.tiles.size());
  for (std::size_t k = 0; k < found.tiles.size(); ++k) {
    EXPECT_EQ(found.tiles[k].parts, expected.tiles[k].parts);
    EXPECT_EQ(found.tiles[k].loops, expected.tiles[k].loops);
  }
  EXPECT_EQ(found.vertices, expected.vertices);
}

}  // namespace
}  // namespace dapple::test
