// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/sides.hpp"

namespace dapple::test {
namespace {

Shape cuboid(int cells, double x, double y, double z) {
  return mapped(box(cells), [=](const Vec3& p) { return Vec3(x * p.x(), y * p.y(), z * p.z()); });
}

Shape plate(int cells) { return cuboid(cells, 1.0, 1.0, 0.002); }

/// A wall whose sides meet at a sharp edge on one end and are far apart on the other.
Shape wedge(double thickness) {
  return mapped(box(20), [=](const Vec3& p) {
    return Vec3(p.x(), p.y(), thickness * (p.z() - 0.5) * p.x() * p.x());
  });
}

/// A round plate with a hole whose upper part sticks out as a lip; its underside is four strips.
Shape plate_with_lip() {
  std::vector<std::pair<double, double>> profile;  // radius and height
  for (int k = 0; k <= 10; ++k) profile.emplace_back(1.0 - 0.06 * k, 0.0);
  for (int k = 0; k <= 10; ++k) profile.emplace_back(0.4 + 0.0565 * k, -0.023);
  for (int k = 0; k <= 4; ++k) profile.emplace_back(0.965 + 0.00875 * k, -0.0035);
  const auto count = static_cast<int>(profile.size());
  return mapped(torus(64, count), [=](const Vec3& p) {
    const double radius = std::hypot(p.x(), p.y());
    const double turn = std::atan2(p.z(), radius - 1.0) / (2.0 * std::numbers::pi);
    const auto place = static_cast<std::size_t>((std::lround(count * turn) + count) % count);
    const auto [r, z] = profile[place];
    return Vec3(r * p.x() / radius, r * p.y() / radius, z);
  });
}

std::int32_t components(const Surface& surface) { return surface.ordered().components(); }

double mass_of(const Surface& surface, std::int32_t component) {
  double mass = 0.0;
  for (std::size_t f = 0; f < surface.face_count(); ++f)
    if (surface.ordered().component(nth_face(f)) == component)
      mass += surface.ordered().geometry(nth_face(f)).moments.capacity;
  return mass;
}

TEST(Sides, APlateHasTwoHoweverFewItsFacesAre) {
  for (const int cells : {1, 7, 30}) {
    const Surface surface = plate(cells).surface();
    const auto sided = with_sides(surface, 500);
    ASSERT_NE(sided, nullptr) << cells;
    EXPECT_EQ(components(sided->all), 2);
    EXPECT_NEAR(mass_of(sided->all, 0), 0.5 * surface.capacity(), 0.01 * surface.capacity());
    EXPECT_NEAR(sided->all.area(), surface.area(), 1e-12);
    EXPECT_EQ(sided->all.faces(), surface.faces());
    EXPECT_EQ(sided->all.vertices(), surface.vertices());
    EXPECT_NEAR(sided->without_rims.capacity(), 2.0, 1e-12);
  }
}

TEST(Sides, DoubledFacesOfAWallCountOnce) {
  // The upper side twice, with vertices of its own.
  Shape shape = plate(7);
  const Shape once = shape;
  const auto behind = static_cast<std::int32_t>(once.vertices.size());
  shape.vertices.insert(shape.vertices.end(), once.vertices.begin(), once.vertices.end());
  for (const auto& [a, b, c] : once.faces)
    if (once.vertices[static_cast<std::size_t>(a)].z() > 0.0019 &&
        once.vertices[static_cast<std::size_t>(b)].z() > 0.0019 &&
        once.vertices[static_cast<std::size_t>(c)].z() > 0.0019)
      shape.faces.push_back({a + behind, b + behind, c + behind});
  const Surface surface = shape.surface();
  ASSERT_EQ(surface.doubled_faces(), 98);
  const auto sided = with_sides(surface, 500);
  ASSERT_NE(sided, nullptr);
  EXPECT_EQ(sided->all.doubled_faces(), surface.doubled_faces());
  EXPECT_NEAR(sided->all.area(), once.surface().area(), 1e-12);
  EXPECT_LE(sample(surface, 500).report.evenness.capacity_variation, 0.01);
}

TEST(Sides, ASurfaceWithoutThinWallsStaysAsItIs) {
  for (const Shape& shape : all_shapes())
    if (shape.name != "TwoSheets") {
      EXPECT_EQ(with_sides(shape.surface(), 40), nullptr) << shape.name;
    }
  EXPECT_EQ(with_sides(box(10).surface(), 3000), nullptr);
  EXPECT_EQ(with_sides(icosphere(4).surface(), 12), nullptr);
  EXPECT_EQ(with_sides(cuboid(10, 1.0, 1.0, 0.05).surface(), 500), nullptr);
}

TEST(Sides, FewCellsOnASideGoAroundTheRim) {
  EXPECT_EQ(with_sides(plate(10).surface(), 18), nullptr);
  EXPECT_NE(with_sides(plate(10).surface(), 22), nullptr);
}

TEST(Sides, WiresAndRibbonsHaveNone) {
  EXPECT_EQ(with_sides(cuboid(20, 4.0, 0.01, 0.002).surface(), 50), nullptr);
  EXPECT_EQ(with_sides(cuboid(20, 4.0, 0.01, 0.01).surface(), 50), nullptr);
}

TEST(Sides, WallsThatMeetInAThickPartStayConnected) {
  EXPECT_EQ(with_sides(wedge(0.3).surface(), 500), nullptr);
}

TEST(Sides, TheTopOfATableIsASide) {
  // A plate with a thick leg in one mesh: the leg continues the lower side.
  const Shape table = mapped(box(30), [](const Vec3& p) {
    const bool leg = std::abs(p.x() - 0.5) < 0.15 && std::abs(p.y() - 0.5) < 0.15;
    return Vec3(p.x(), p.y(), p.z() == 0.0 && leg ? -0.6 : 0.01 * p.z());
  });
  const auto sided = with_sides(table.surface(), 500);
  ASSERT_NE(sided, nullptr);
  EXPECT_EQ(components(sided->all), 2);
}

TEST(Sides, NoiseCreatesNone) {
  Random random(7);
  Shape shape = grid(100);
  for (Vec3& v : shape.vertices) v += 0.02 * random.in_box();
  EXPECT_EQ(with_sides(shape.surface(), 100), nullptr);
}

TEST(Sides, NoCellOfOneSideHasAPieceOfTheOther) {
  const Shape shape = plate(12);
  const Surface surface = shape.surface();
  Random random(3);
  const Sites sites = random_sites(shape, 300, random);
  double capacity = 0.0;
  for (const Moments& cell : restricted_voronoi(surface, sites, Cells::kConnected).cells)
    capacity += cell.capacity;
  EXPECT_NEAR(capacity, surface.capacity(), 1e-12);
  const auto is_above = [&](std::int32_t face) {
    return surface.ordered().geometry(surface.ordered().ordered_face(face)).normal.z();
  };
  for (const CellPolygon& piece : restricted_voronoi_polygons(surface, sites, Cells::kConnected)) {
    const std::int32_t face = sites.faces[static_cast<std::size_t>(piece.site)];
    EXPECT_GE(is_above(piece.face) * is_above(face), 0.0);
  }
}

TEST(Sides, RimsThatAreNotNarrowKeepTheirSites) {
  // thickness in spacings; returns the expected share by area
  const auto on_rim = [](double thickness) {
    const Surface surface = cuboid(24, 1.0, 1.0, 0.068 * thickness).surface();
    const Samples samples = sample(surface, 500);
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.01) << thickness;
    const auto is_on_rim = [](const Vec3& normal) { return std::abs(normal.z()) < 0.5; };
    const auto found = std::ranges::count_if(samples.normals, is_on_rim);
    return static_cast<double>(found) / (500.0 * (1.0 - 2.0 / surface.area()));
  };
  EXPECT_EQ(on_rim(0.2), 0.0);
  EXPECT_GT(on_rim(0.4), 0.4);
  EXPECT_LT(on_rim(0.4), 2.0);
}

TEST(Sides, TheUndersideOfALipIsNotDivided) {
  // A border within it would part points that stand side by side.
  const Surface surface = plate_with_lip().surface();
  const auto sided = with_sides(surface, 1000);
  ASSERT_NE(sided, nullptr);
  EXPECT_EQ(components(sided->all), 2);
  const OrderedSurface& mesh = sided->all.ordered();
  std::set<std::int32_t> below;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const FaceGeometry& face = mesh.geometry(nth_face(f));
    const double radius = std::hypot(face.centroid.x(), face.centroid.y());
    if (face.normal.z() < -0.99 && radius > 0.965) below.insert(mesh.component(nth_face(f)));
  }
  EXPECT_EQ(below.size(), 1);
}

TEST(Sides, AMovingWallKeepsThem) {
  const Surface surface = plate(12).surface();
  const auto sided = with_sides(surface, 500);
  ASSERT_NE(sided, nullptr);
  const Surface bent = surface.deformed(deformed(surface.vertices(), 0.3));
  const auto moved = with_sides_of(*sided, bent);
  EXPECT_EQ(components(moved->all), 2);
  EXPECT_NEAR(moved->all.area(), bent.area(), 1e-12);
  EXPECT_EQ(moved->rims, sided->rims);
}

TEST(Sides, ATrackedPlateStaysEven) {
  const Surface surface = plate(24).surface();
  Tracker tracker(surface, sample(surface, 400));
  for (int frame = 1; frame <= 4; ++frame) {
    const Samples& now = tracker.advance(deformed(surface.vertices(), 0.1 * frame));
    EXPECT_LE(now.report.evenness.capacity_variation, 0.02) << frame;
    EXPECT_GE(now.report.evenness.alpha_min, 0.6) << frame;
  }
}

}  // namespace
}  // namespace dapple::test
