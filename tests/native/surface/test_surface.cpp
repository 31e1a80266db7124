// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/surface.hpp>
#include <limits>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Surface, TellsWhetherVerticesAreItsOwn) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  std::vector<Vec3> vertices = shape.vertices;
  EXPECT_TRUE(surface.ordered().has_vertices(vertices));
  vertices.push_back(Vec3(1, 2, 3));
  EXPECT_FALSE(surface.ordered().has_vertices(vertices));
  vertices.resize(shape.vertices.size());
  vertices.back().y() += 1e-9;
  EXPECT_FALSE(surface.ordered().has_vertices(vertices));
}

class SurfaceOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, SurfaceOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(SurfaceOf, MeasuresAreaAndMass) {
  const Surface surface = GetParam().surface();
  EXPECT_NEAR(surface.area(), GetParam().area(), 1e-12 * GetParam().area());
  EXPECT_NEAR(surface.capacity(), GetParam().capacity(), 1e-12 * GetParam().capacity());
  EXPECT_EQ(surface.uniform(), GetParam().density.empty());
}

TEST_P(SurfaceOf, ReturnsTheArraysItWasGiven) {
  const Surface surface = GetParam().surface();
  EXPECT_EQ(surface.faces(), GetParam().faces);
  EXPECT_EQ(surface.density(), GetParam().density);
  EXPECT_EQ(surface.density_at(), GetParam().density_at);
  EXPECT_TRUE(same_bytes(surface.vertices(), GetParam().vertices));
}

TEST_P(SurfaceOf, OrdersFacesOneToOne) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(shape.faces.size()); ++f) {
    ASSERT_EQ(surface.ordered().original_face(surface.ordered().ordered_face(f)), f);
    const Vec3 middle = shape.point(f, Vec3::Constant(1.0 / 3.0));
    const Face& corners = surface.ordered().corners(surface.ordered().ordered_face(f));
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_EQ(
          surface.ordered().vertex(corners[c]),
          shape.vertices[static_cast<std::size_t>(shape.faces[static_cast<std::size_t>(f)][c])]);
    ASSERT_LE(
        (surface.ordered().geometry(surface.ordered().ordered_face(f)).centroid - middle).norm(),
        1e-13 * (1.0 + middle.norm()));
  }
}

/// Walking around an edge meets every half-edge on it exactly once.
TEST_P(SurfaceOf, WalksRingsAroundEdges) {
  const Surface surface = GetParam().surface();
  const auto half_edges = static_cast<std::int32_t>(3 * surface.face_count());
  const auto ends = [&](std::int32_t half_edge) {
    const Face& corners = surface.ordered().corners(face_of(half_edge));
    const auto c = static_cast<std::size_t>(half_edge % 3);
    return std::minmax({corners[c], corners[(c + 1) % 3]});
  };
  for (std::int32_t start = 0; start < half_edges; ++start) {
    std::int32_t in_ring = 0, on_edge = 0;
    std::int32_t h = start;
    do {
      ASSERT_EQ(ends(h), ends(start));
      ++in_ring;
      h = surface.ordered().next_around(h);
    } while (h != start && in_ring <= half_edges);
    const bool counts = surface.ordered().counts(face_of(start));
    for (std::int32_t other = 0; other < half_edges; ++other)
      on_edge += ends(other) == ends(start) && surface.ordered().counts(face_of(other)) ? 1 : 0;
    ASSERT_EQ(in_ring, counts ? on_edge : 1) << "half-edge " << start;
  }
}

TEST_P(SurfaceOf, DeformsAsIfBuiltAnew) {
  const Shape& shape = GetParam();
  const std::vector<Vec3> moved = deformed(shape.vertices, 1.3);
  const Surface carried = shape.surface().deformed(moved);
  const Surface fresh(moved, shape.faces, Density{shape.density_at, shape.density});
  EXPECT_TRUE(same_bytes(carried.vertices(), moved));
  EXPECT_EQ(carried.faces(), shape.faces);
  EXPECT_EQ(carried.density(), shape.density);
  EXPECT_EQ(carried.density_at(), shape.density_at);
  EXPECT_NEAR(carried.area(), fresh.area(), 1e-14 * fresh.area());
  EXPECT_NEAR(carried.capacity(), fresh.capacity(), 1e-14 * fresh.capacity());
}

TEST_P(SurfaceOf, ExchangesItsDensityAsIfBuiltAnew) {
  const Shape& shape = GetParam();
  const Surface other = with_face_density(shape, [](const Vec3& p) { return p.norm(); }).surface();
  const Surface same = other.with_density({shape.density_at, shape.density});
  const Surface fresh = shape.surface();
  EXPECT_EQ(same.density(), shape.density);
  EXPECT_EQ(same.uniform(), fresh.uniform());
  EXPECT_EQ(same.capacity(), fresh.capacity());
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(shape.faces.size()); ++f) {
    ASSERT_EQ(same.ordered().densities(OrderedFace{f}), fresh.ordered().densities(OrderedFace{f}));
    ASSERT_EQ(same.ordered().geometry(OrderedFace{f}).moments.second,
              fresh.ordered().geometry(OrderedFace{f}).moments.second);
  }
}

/// Measurements are shared where nothing has changed.
TEST(Surface, MeasuresAnewOnlyWhatHasChanged) {
  const Shape shape = icosphere(5);
  const Surface surface = shape.surface();
  std::vector<Vec3> vertices = shape.vertices;
  std::vector<double> density(vertices.size(), 1.0), denser = density;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (shape.vertices[v].z() > 0.95) {
      vertices[v] *= 1.1;
      denser[v] = 2.0;
    }
  const Surface dense = surface.with_density({DensityAt::kVertices, density});
  const Surface cases[2][2] = {{surface, surface.deformed(vertices)},
                               {dense, dense.with_density({DensityAt::kVertices, denser})}};
  const Surface anew[2] = {Surface(vertices, shape.faces),
                           Surface(shape.vertices, shape.faces, denser)};
  for (int k = 0; k < 2; ++k) {
    const OrderedSurface& before = cases[k][0].ordered();
    const OrderedSurface& after = cases[k][1].ordered();
    std::size_t shared = 0;
    for (std::size_t f = 0; f < surface.face_count(); ++f) {
      const OrderedFace face = nth_face(f);
      shared += &before.geometry(face) == &after.geometry(face) ? 1 : 0;
      EXPECT_EQ(after.geometry(face).moments.capacity,
                anew[k]
                    .ordered()
                    .geometry(anew[k].ordered().ordered_face(after.original_face(face)))
                    .moments.capacity);
    }
    EXPECT_GT(shared, surface.face_count() / 2);
    EXPECT_LT(shared, surface.face_count());
    EXPECT_NEAR(cases[k][1].capacity(), anew[k].capacity(), 1e-12 * anew[k].capacity());
    EXPECT_NEAR(cases[k][1].area(), anew[k].area(), 1e-12 * anew[k].area());
  }
}

TEST_P(SurfaceOf, KnowsTheDensityAtTheCornersOfItsFaces) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(shape.faces.size()); ++f)
    ASSERT_EQ(surface.ordered().densities(surface.ordered().ordered_face(f)), shape.densities(f));
}

TEST_P(SurfaceOf, GivesUnitNormalsEverywhere) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  Random random(3);
  const Sites sites = random_sites(shape, 50, random);
  const std::vector<Vec3> weights(sites.size(), Vec3(0.2, 0.5, 0.3));
  for (const Vec3& normal : surface.normals(sites.faces, weights))
    EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
}

TEST(Surface, PutsAPointAtItsWeights) {
  const Shape shape = blob(1);
  const Surface surface = shape.surface();
  Random random(5);
  for (std::int32_t f = 0; f < 80; ++f) {
    const Vec3 weights = random.weights();
    EXPECT_LE((surface.point(f, weights) - shape.point(f, weights)).norm(), 1e-15);
  }
}

TEST(Surface, SpacesHexagonally) {
  EXPECT_NEAR(grid(2).surface().spacing(50), std::sqrt(2.0 / (std::numbers::sqrt3 * 50.0)), 1e-15);
}

/// Squared lengths of its edges overflow.
TEST(Surface, GivesUnitNormalsWhereAFaceWithoutAreaReachesFar) {
  const std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e155, 0, 0}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 3, 1}};
  const Surface surface(vertices, faces);
  for (const Vec3& normal : surface.corner_normals()) EXPECT_EQ(normal, Vec3::UnitZ());
}

TEST(Surface, GivesAUnitNormalWhereAFaceHasNoArea) {
  Shape shape = triangle();
  const Vec3 corner = shape.vertices[0];
  for (int k = 0; k < 3; ++k) shape.vertices.push_back(corner + Vec3(0.0, 0.0, 1.0));
  shape.faces.push_back({3, 4, 5});
  const Surface surface(shape.vertices, shape.faces, {}, {.weld = std::nullopt});
  const std::vector<std::int32_t> faces = {1};
  const std::vector<Vec3> weights = {{0.5, 0.25, 0.25}};
  EXPECT_EQ(surface.normals(faces, weights)[0].norm(), 1.0);
}

TEST(Surface, InterpolatesSphereNormals) {
  const Shape shape = icosphere(3);
  const Surface surface = shape.surface();
  Random random(1);
  const Sites sites = random_sites(shape, 100, random);
  const std::vector<Vec3> weights(sites.size(), Vec3::Constant(1.0 / 3.0));
  const std::vector<Vec3> normals = surface.normals(sites.faces, weights);
  for (std::size_t k = 0; k < sites.size(); ++k)
    EXPECT_GT(normals[k].dot(surface.point(sites.faces[k], weights[k]).normalized()), 0.9999);
}

TEST(Surface, HasTheGradientOfItsDensity) {
  const Vec3 slope(0.3, 0.7, -0.2);
  const Shape shape = with_density(blob(1), [&](const Vec3& p) { return 5.0 + slope.dot(p); });
  const Surface surface = shape.surface();
  for (std::int32_t f = 0; f < 80; ++f) {
    const FaceGeometry& face = surface.ordered().geometry(OrderedFace{f});
    const Vec3 tangential = slope - slope.dot(face.normal) * face.normal;
    EXPECT_LE((face.density_gradient - tangential).norm(), 1e-12);
  }
}

TEST(Surface, NamesTheFirstVertexThatIsNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity})
    for (int axis = 0; axis < 3; ++axis) {
      Shape shape = blob(1);
      shape.vertices[17][axis] = bad;
      shape.vertices[30][0] = bad;
      expect_message<SurfaceError>([&] { (void)shape.surface(); },
                                   {"vertices[17]", std::to_string(bad)});
    }
}

TEST(Surface, NamesTheFirstFaceOutOfRange) {
  const std::int32_t past = static_cast<std::int32_t>(blob(1).vertices.size());
  for (const std::int32_t bad :
       {-1, past, std::numeric_limits<std::int32_t>::max(), -2147483647 - 1})
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Shape shape = blob(1);
      shape.faces[5][corner] = bad;
      shape.faces[9][0] = bad;
      expect_message<SurfaceError>([&] { (void)shape.surface(); },
                                   {"faces[5]", std::to_string(bad)});
    }
}

TEST(Surface, NamesTheFirstBadDensity) {
  const std::vector<std::pair<double, std::string>> cases = {
      {kNan, "nan"}, {kInfinity, "inf"}, {-0.5, "-0.5"}};
  for (const auto& [bad, text] : cases) {
    Shape shape = with_density(blob(1), [](const Vec3&) { return 1.0; });
    shape.density[11] = bad;
    shape.density[12] = -9.0;
    expect_message<SurfaceError>([&] { (void)shape.surface(); }, {"density[11]", text});
  }
}

TEST(Surface, RefusesDensityOfAnotherLength) {
  Shape shape = grid(2);
  shape.density.assign(8, 1.0);
  expect_message<SurfaceError>([&] { (void)shape.surface(); }, {"density", "8", "9"});
}

TEST(Surface, NamesTheFirstBadDensityOfAFaceOrCorner) {
  const Shape shape = grid(2);
  std::vector<double> values(24, 1.0);
  values[17] = values[20] = -0.5;
  expect_message<SurfaceError>(
      [&] { (void)shape.surface().with_density({DensityAt::kCorners, values}); },
      {"density[5, 2]", "-0.5"});
  values.assign(8, 1.0);
  values[3] = values[4] = kNan;
  expect_message<SurfaceError>(
      [&] { Surface(shape.vertices, shape.faces, Density{DensityAt::kFaces, values}); },
      {"density[3]", "nan"});
}

TEST(Surface, RefusesDensityOfAnotherLengthAtFacesOrCorners) {
  const Surface surface = grid(2).surface();
  const std::vector<double> nine(9, 1.0);
  expect_message<SurfaceError>([&] { (void)surface.with_density({DensityAt::kFaces, nine}); },
                               {"density", "9", "8 faces"});
  expect_message<SurfaceError>([&] { (void)surface.with_density({DensityAt::kCorners, nine}); },
                               {"density", "9", "24 corners"});
}

TEST(Surface, RefusesZeroDensityEverywhere) {
  const Shape shape = with_density(grid(2), [](const Vec3&) { return 0.0; });
  expect_message<SurfaceError>([&] { (void)shape.surface(); }, {"density"});
}

TEST(Surface, RefusesADensityWhoseIntegralIsNotFinite) {
  Shape shape = with_density(grid(2), [](const Vec3&) { return 1.7e308; });
  for (Vec3& v : shape.vertices) v *= 10.0;
  expect_message<SurfaceError>([&] { (void)shape.surface(); }, {"density", "not finite"});
  for (Vec3& v : shape.vertices) v /= 20.0;
  const Surface surface = shape.surface();
  EXPECT_TRUE(std::isfinite(surface.capacity()));
  std::vector<Vec3> larger = surface.vertices();
  for (Vec3& v : larger) v *= 100.0;
  expect_message<SurfaceError>([&] { (void)surface.deformed(larger); }, {"density", "not finite"});
}

TEST(Surface, RefusesNothing) {
  expect_message<SurfaceError>([] { Surface({}, {}); }, {"faces"});
  const Shape shape = grid(1);
  expect_message<SurfaceError>([&] { Surface(shape.vertices, {}); }, {"faces"});
  expect_message<SurfaceError>([&] { Surface({}, shape.faces); }, {"faces[0]"});
}

TEST(Surface, RefusesFacesWithoutArea) {
  const Shape line{"Line", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}, {0, 0, 1}}};
  expect_message<SurfaceError>([&] { (void)line.surface(); }, {"area"});
}

TEST(Surface, RefusesCoordinatesWhoseAreaOverflows) {
  const Shape huge = mapped(grid(1), [](const Vec3& p) { return Vec3(1e200 * p); });
  expect_message<SurfaceError>([&] { (void)huge.surface(); }, {"vertices"});
}

TEST(Surface, RefusesBodiesOfAnotherLength) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Face> faces = {{0, 1, 2}};
  const std::vector<std::int32_t> edges = {0, 1, 2}, places = {0, 1, 2}, bodies = {0, 0};
  expect_message<SurfaceError>(
      [&] { (void)Surface(vertices, faces, Density{}, Joints{edges, places, bodies}); },
      {"joints has 2 bodies for 1 faces"});
}

TEST(Surface, RefusesToDeformBadly) {
  const Surface surface = grid(2).surface();
  std::vector<Vec3> vertices = surface.vertices();
  vertices[4].y() = kNan;
  expect_message<SurfaceError>([&] { (void)surface.deformed(vertices); }, {"vertices[4]", "nan"});
  vertices.resize(8);
  expect_message<SurfaceError>([&] { (void)surface.deformed(vertices); }, {"vertices", "8", "9"});
}

}  // namespace
}  // namespace dapple::test
