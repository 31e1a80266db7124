// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <numbers>
#include <vector>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/sides.hpp"

namespace dapple::test {
namespace {

Shape sheet(const Vec3& to, double length = 1.0) {
  return mapped(grid(12),
                [=](const Vec3& p) { return Vec3(length * p.x() * to + p.y() * Vec3::UnitY()); });
}

/// A flat ground from x = -1 to 1, from whose middle a fin rises at an angle.
Shape fin(double degrees, double length = 1.0) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return joined(joined(sheet(-Vec3::UnitX()), sheet(Vec3::UnitX())),
                sheet({std::cos(angle), 0.0, std::sin(angle)}, length));
}

/// Two closed shells with the same lower half, of which the outer one bulges. As in a file, each
/// has vertices and faces of its own.
Shape two_shells() {
  const Shape inner = box(12);
  return joined(inner, mapped(inner, [](const Vec3& p) {
                  const double up = std::max(p.z() - 0.5, 0.0);
                  return Vec3(p + 0.1 * up * (p - Vec3(0.5, 0.5, 0.5)));
                }));
}

std::int32_t sheets(const Shape& shape, std::size_t count) {
  const auto sided = with_sides(shape.surface(), count);
  return sided ? sided->all.ordered().components() : shape.surface().ordered().components();
}

TEST(Sheets, AFinAtASmallAngleIsOnItsOwn) {
  for (const double degrees : {0.5, 5.0, 18.0}) {
    EXPECT_EQ(sheets(fin(degrees), 300), 2) << degrees;
    EXPECT_EQ(sheets(fin(180.0 - degrees), 300), 2) << degrees;
  }
  for (const double degrees : {25.0, 90.0}) EXPECT_EQ(sheets(fin(degrees), 300), 1) << degrees;
}

TEST(Sheets, TheStraightestContinuesTheGround) {
  const auto sided = with_sides(fin(10.0).surface(), 300);
  ASSERT_NE(sided, nullptr);
  const OrderedSurface& mesh = sided->all.ordered();
  const auto component = [&](std::size_t k) {  // of the sheet with so many before it
    return mesh.component(mesh.ordered_face(static_cast<std::int32_t>(2 * 12 * 12 * k)));
  };
  EXPECT_EQ(component(0), component(1));
  EXPECT_NE(component(0), component(2));
}

TEST(Sheets, AFinOfAFewCellsStaysConnected) {
  EXPECT_EQ(sheets(fin(10.0, 0.06), 300), 1);
  EXPECT_EQ(sheets(fin(10.0, 0.1), 300), 2);
}

TEST(Sheets, SamplesAreEvenOnAFinAtASmallAngle) {
  for (const double degrees : {3.0, 10.0, 18.0})
    for (const std::uint64_t seed : {0, 1, 2}) {
      SampleOptions options;
      options.seed = seed;
      const Report report = sample(fin(degrees).surface(), 300, options).report;
      EXPECT_LE(report.evenness.capacity_variation, 0.01) << degrees << " " << seed;
      EXPECT_GE(report.evenness.alpha_min, 0.6) << degrees << " " << seed;
      EXPECT_TRUE(report.converged) << degrees << " " << seed;
    }
}

TEST(Sheets, SamplesAreEvenOnTwoShellsThatShareFaces) {
  const Surface surface = two_shells().surface();
  ASSERT_GT(surface.doubled_faces(), 0);
  EXPECT_EQ(sheets(two_shells(), 500), 2);
  for (const std::uint64_t seed : {0, 1, 2}) {
    SampleOptions options;
    options.seed = seed;
    const Report report = sample(surface, 500, options).report;
    EXPECT_LE(report.evenness.capacity_variation, 0.01) << seed;
    EXPECT_GE(report.evenness.alpha_min, 0.6) << seed;
    EXPECT_TRUE(report.converged) << seed;
  }
}

TEST(Sheets, FacesWithoutAreaAtTheirEdgeChangeNothing) {
  Shape shape = fin(10.0);
  for (std::int32_t k = 0; k < 12; ++k) shape.faces.push_back({k, k, k + 1});
  for (std::int32_t k = 0; k + 2 < 13; ++k) shape.faces.push_back({k, k + 1, k + 2});
  EXPECT_EQ(sheets(shape, 300), 2);
}

TEST(Sheets, FacesThatAllLieOnEachOtherStayConnected) {
  Shape shape = grid(6);
  const std::vector<Face> once = shape.faces;
  for (int k = 0; k < 2; ++k) shape.faces.insert(shape.faces.end(), once.begin(), once.end());
  const Surface surface(shape.vertices, shape.faces, {}, {.merge_doubled = false});
  EXPECT_EQ(surface.ordered().components(), 1);
  EXPECT_EQ(with_sides(surface, 100), nullptr);
}

TEST(Sheets, ManyFacesAtOneEdgeStayConnected) {
  Shape shape = sheet(Vec3::UnitX());
  for (int k = 1; k < 20; ++k) {
    const double angle = k * std::numbers::pi / 30.0;
    shape = joined(shape, sheet({std::cos(angle), 0.0, std::sin(angle)}));
  }
  EXPECT_EQ(sheets(shape, 1000), 1);
}

TEST(Sheets, AFinThatMovesKeepsItsSamples) {
  const Shape shape = fin(10.0);
  Tracker tracker(shape.surface(), sample(shape.surface(), 300));
  for (const double degrees : {12.0, 30.0, 60.0, 5.0}) {
    const Samples samples = tracker.advance(fin(degrees).vertices);
    EXPECT_EQ(samples.positions.size(), 300);
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.02) << degrees;
  }
}

}  // namespace
}  // namespace dapple::test
