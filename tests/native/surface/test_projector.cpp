// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/projector.hpp>
#include <limits>

#include "brute_force.hpp"
#include "invariants.hpp"
#include "shared_data.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

struct Closest {
  Vec3 position;
  double distance = std::numeric_limits<double>::infinity();
  std::int32_t face = -1;
};

Closest brute_force_closest(const Shape& shape, const Vec3& point) {
  Closest best;
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    const auto corner = [&](std::size_t c) {
      return shape.vertices[static_cast<std::size_t>(shape.faces[f][c])];
    };
    const Vec3 candidate = closest_on_triangle(point, corner(0), corner(1), corner(2));
    const double distance = (candidate - point).norm();
    if (distance < best.distance) best = {candidate, distance, static_cast<std::int32_t>(f)};
  }
  return best;
}

/// The center and half the extent.
std::pair<Vec3, double> extent(const Shape& shape) {
  Vec3 low = shape.vertices[0], high = low;
  for (const Face& face : shape.faces)
    for (const std::int32_t v : face) {
      low = low.cwiseMin(shape.vertices[static_cast<std::size_t>(v)]);
      high = high.cwiseMax(shape.vertices[static_cast<std::size_t>(v)]);
    }
  return {0.5 * (low + high), 0.5 * (high - low).maxCoeff()};
}

/// Points within `reach` times the size of the surface.
std::vector<Vec3> points_around(const Shape& shape, double reach, std::size_t count,
                                Random& random) {
  const auto [middle, size] = extent(shape);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = middle + reach * size * random.in_box();
  return points;
}

void expect_closest(const Shape& shape, const std::vector<Vec3>& points) {
  const Surface surface = shape.surface();
  const Projection found = Projector(surface).project(points);
  check_on_surface(surface, {found.positions, found.faces}, found.barycentric);
  const auto [middle, size] = extent(shape);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Closest expected = brute_force_closest(shape, points[k]);
    const double rounding =
        1e-14 * (middle.norm() + size + points[k].norm()) + 1e-13 * expected.distance;
    EXPECT_NEAR(found.distances[k], expected.distance, rounding) << shape.name << ", point " << k;
    EXPECT_NEAR((found.positions[k] - points[k]).norm(), found.distances[k], rounding);
  }
}

class ProjectorOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ProjectorOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ProjectorOn, FindsTheClosestPoint) {
  Random random(61);
  expect_closest(GetParam(), points_around(GetParam(), 1.2, 300, random));
}

TEST_P(ProjectorOn, FindsTheClosestPointFromAfar) {
  Random random(62);
  expect_closest(GetParam(), points_around(GetParam(), 50.0, 100, random));
  expect_closest(GetParam(), points_around(GetParam(), 1e6, 20, random));
}

TEST_P(ProjectorOn, LeavesPointsOfTheSurfaceWhereTheyAre) {
  Random random(63);
  const Sites sites = random_sites(GetParam(), 200, random);
  const Projection found = Projector(GetParam().surface()).project(sites.positions);
  const double size = extent(GetParam()).second;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    EXPECT_LE(found.distances[k], 1e-14 * size);
    EXPECT_LE((found.positions[k] - sites.positions[k]).norm(), 1e-14 * size);
  }
}

TEST_P(ProjectorOn, FindsTheFacesWithinARadius) {
  const Shape& shape = GetParam();
  Random random(65);
  const double size = extent(shape).second;
  const std::vector<Vec3> points = points_around(shape, 1.2, 40, random);
  std::vector<double> radii;
  for (std::size_t k = 0; k < points.size(); ++k) radii.push_back(size * random.between(0.01, 1.0));
  const std::vector<bool> counts = shape.counted();
  const auto found = Projector(shape.surface()).faces_within(points, radii);
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t f = 0; f < shape.faces.size(); ++f) {
      const auto corner = [&](std::size_t c) {
        return shape.vertices[static_cast<std::size_t>(shape.faces[f][c])];
      };
      const Vec3 closest = closest_on_triangle(points[k], corner(0), corner(1), corner(2));
      const double inside = radii[k] - (closest - points[k]).norm();
      if (std::abs(inside) < 1e-12 * size || shape.face_area(static_cast<std::int32_t>(f)) <= 0.0)
        continue;
      ASSERT_EQ(std::binary_search(found[k].begin(), found[k].end(), static_cast<std::int32_t>(f)),
                inside > 0.0 && counts[f])
          << "point " << k << ", face " << f;
    }
}

TEST_P(ProjectorOn, GivesTheSameBytesForAnyHint) {
  Random random(64);
  const std::vector<Vec3> points = points_around(GetParam(), 1.2, 200, random);
  const Projector projector(GetParam().surface());
  const Projection base = projector.project(points);
  for (int trial = 0; trial < 3; ++trial) {
    std::vector<std::int32_t> hints(points.size());
    for (std::int32_t& hint : hints)
      hint = random.below(static_cast<std::int32_t>(GetParam().faces.size()));
    const Projection hinted = projector.project(points, hints);
    EXPECT_EQ(hinted.faces, base.faces);
    EXPECT_EQ(hinted.distances, base.distances);
    EXPECT_TRUE(same_bytes(hinted.positions, base.positions));
    EXPECT_TRUE(same_bytes(hinted.barycentric, base.barycentric));
  }
}

/// Without ties the face is the same as well.
TEST(Projector, FindsTheClosestFace) {
  const Shape shape = blob(3);
  Random random(65);
  std::vector<Vec3> points;
  std::vector<std::int32_t> faces;
  const Surface surface = shape.surface();
  const Sites sites = random_sites(shape, 500, random, true);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Vec3& normal =
        surface.ordered().geometry(surface.ordered().ordered_face(sites.faces[k])).normal;
    points.emplace_back(sites.positions[k] + 1e-4 * normal);
  }
  EXPECT_EQ(Projector(surface).project(points).faces, sites.faces);
}

// On these shapes all sums are exact in double precision, so ties are exact.
TEST(Projector, GivesTiesToTheLowestFace) {
  const Shape sheet = grid(4);
  std::vector<Vec3> points;
  for (int x = 0; x <= 8; ++x)
    for (int y = 0; y <= 8; ++y)
      for (const double z : {0.0, 0.25, -4.0}) points.emplace_back(0.125 * x, 0.125 * y, z);
  const Projection found = Projector(sheet.surface()).project(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_EQ(found.faces[k], brute_force_closest(sheet, points[k]).face) << points[k].transpose();
}

TEST(Projector, GivesTiesToTheLowestFaceWhateverTheOrderOfFaces) {
  Shape shape = octahedron();
  const std::vector<Vec3> points = {{2, 0, 0}, {0, 0, -3}, {1, 1, 0}, {0, 2, 2}, {0, 0, 0}};
  for (std::size_t turn = 0; turn < shape.faces.size(); ++turn) {
    std::rotate(shape.faces.begin(), shape.faces.begin() + 1, shape.faces.end());
    const Projection found = Projector(shape.surface()).project(points);
    // the center is equally far from all faces only up to rounding
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(found.faces[k], brute_force_closest(shape, points[k]).face)
          << points[k].transpose();
  }
}

TEST(Projector, GivesTheFirstOfDuplicateFaces) {
  const Shape shape = joined(joined(grid(2), grid(2)), grid(2));
  const Projection found =
      Projector(shape.surface()).project(std::vector<Vec3>{{0.3, 0.1, 1}, {0.9, 0.8, -1}});
  EXPECT_LT(found.faces[0], 8);
  EXPECT_LT(found.faces[1], 8);
}

struct Frame {
  double scale, shift;
};

class ProjectorInUnits : public testing::TestWithParam<Frame> {};

INSTANTIATE_TEST_SUITE_P(Frames, ProjectorInUnits,
                         testing::Values(Frame{1e-6, 0}, Frame{1e6, 0}, Frame{1, 1e6},
                                         Frame{1e-6, 1}, Frame{1e6, 1e9}, Frame{1e-12, 0},
                                         Frame{1e12, 0}));

TEST_P(ProjectorInUnits, FindsTheClosestPoint) {
  const auto [scale, shift] = GetParam();
  const auto map = [scale = scale, shift = shift](const Vec3& p) {
    return Vec3(scale * p + Vec3(shift, shift, -shift));
  };
  Random random(66);
  for (const Shape& shape : {blob(2), box(3), needle()}) {
    const Shape moved = mapped(shape, map);
    expect_closest(moved, points_around(moved, 1.2, 200, random));
  }
}

class ProjectorOnRealMesh : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Meshes, ProjectorOnRealMesh, testing::ValuesIn(shared_mesh_names()),
                         [](const auto& mesh) { return mesh.param; });

TEST_P(ProjectorOnRealMesh, FindsTheClosestPoint) {
  DAPPLE_NEEDS_MESH(GetParam());
  const Shape shape = shared_mesh(GetParam());
  Random random(67);
  expect_closest(shape, points_around(shape, 1.2, 60, random));
  std::vector<Vec3> near = random_sites(shape, 60, random).positions;
  for (Vec3& p : near) p += 1e-3 * extent(shape).second * random.in_box();
  expect_closest(shape, near);
}

TEST(Projector, ProjectsNothing) {
  const Projection found = Projector(grid(1).surface()).project({});
  EXPECT_TRUE(found.positions.empty());
  EXPECT_TRUE(found.faces.empty());
}

TEST(Projector, OutlivesItsSurfaceAndMoves) {
  Projector first(blob(1).surface());
  Projector second = std::move(first);
  first = Projector(grid(1).surface());
  const std::vector<Vec3> point = {{0.25, 0.5, 1.0}};
  EXPECT_NEAR(first.project(point).distances[0], 1.0, 1e-15);
  EXPECT_NEAR(second.project(point).distances[0], brute_force_closest(blob(1), point[0]).distance,
              1e-14);
}

TEST(Projector, NamesTheFirstPointThatIsNotFinite) {
  std::vector<Vec3> points(5, Vec3::Zero());
  points[3].y() = std::numeric_limits<double>::quiet_NaN();
  const Projector projector(grid(1).surface());
  expect_message<ArgumentError>([&] { (void)projector.project(points); }, {"points[3]", "nan"});
  points[3].y() = std::numeric_limits<double>::infinity();
  expect_message<ArgumentError>([&] { (void)projector.project(points); }, {"points[3]", "inf"});
}

TEST(Projector, NamesTheFirstHintOutOfRange) {
  const std::vector<Vec3> points(3, Vec3::Zero());
  const Projector projector(grid(1).surface());
  for (const std::int32_t bad : {-1, 2}) {
    const std::vector<std::int32_t> hints = {0, 1, bad};
    expect_message<ArgumentError>([&] { (void)projector.project(points, hints); },
                                  {"hints[2]", std::to_string(bad)});
  }
  const std::vector<std::int32_t> few = {0};
  expect_message<ArgumentError>([&] { (void)projector.project(points, few); }, {"hints", "1", "3"});
}

/// Embree alone would round each body to one point and visit all faces for each query.
TEST(Projector, DistinguishesFacesOfBodiesFarApart) {
  for (const double far : {1e3, 1e6, 1e8}) {
    const Shape ball = icosphere(3);
    const Shape other = mapped(ball, [&](const Vec3& x) { return Vec3(x + Vec3(far, 0, 0)); });
    const Shape shape = joined(ball, other);
    const Projector projector(shape.surface());
    Random random(5);
    std::vector<Vec3> points;
    for (int k = 0; k < 100; ++k)
      points.push_back(2.0 * random.in_box() + Vec3(k % 2 == 0 ? 0.0 : far, 0, 0));
    points.push_back(Vec3(0.5 * far, 3, 0));
    points.push_back(Vec3(0, 2 * far, 0));
    const Projection found = projector.project(points);
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_NEAR(found.distances[k], brute_force_closest(shape, points[k]).distance, 1e-12 * far)
          << k;
  }
}

TEST(Projector, MeetsAndGathersBodiesFarApart) {
  const Shape ball = icosphere(3);
  const double far = 1e7;
  const Shape other = mapped(ball, [&](const Vec3& x) { return Vec3(x + Vec3(far, 0, 0)); });
  const Projector projector(joined(ball, other).surface());
  const auto faces = static_cast<std::int32_t>(ball.faces.size());
  const std::vector<Ray> rays = {{Vec3(0, 0, 0), Vec3(1, 0, 0), 2.0},
                                 {Vec3(2, 0.1, 0), Vec3(1, 0, 0), 10.0},
                                 {Vec3(far, 0, 0), Vec3(0, 1, 0), 2.0}};
  const std::vector<std::int32_t> hits = projector.first_hits(rays);
  EXPECT_TRUE(hits[0] >= 0 && hits[0] < faces);
  EXPECT_EQ(hits[1], -1);
  EXPECT_GE(hits[2], faces);
  const std::vector<Vec3> points = {Vec3(1, 0, 0), Vec3(far + 1, 0, 0), Vec3(0.5 * far, 0, 0)};
  const std::vector<double> radii = {0.5, 0.5, 0.6 * far};
  const auto found = projector.faces_within(points, radii);
  EXPECT_TRUE(!found[0].empty() && found[0].back() < faces);
  EXPECT_EQ(found[0].size(), found[1].size());
  EXPECT_EQ(found[2].size(), static_cast<std::size_t>(2 * faces));
}

/// If the squared distance overflows, only the direction determines the closest corner.
TEST(Projector, FindsTheClosestCornerForVeryFarPoints) {
  const Shape shape = octahedron();
  for (const double size : {1e-60, 1.0, 1e60})
    for (const double far : {1e15, 1e155, 1e300}) {
      if (far <= 1e3 * size) continue;
      SCOPED_TRACE("size " + std::to_string(size) + ", at " + std::to_string(far));
      const Surface surface =
          mapped(shape, [&](const Vec3& p) { return Vec3(size * p); }).surface();
      const std::vector<Vec3> points = {{far, 0, 0}, {0, -far, 0}, {0.1 * far, 0, far}};
      const Projection found = Projector(surface).project(points);
      const std::vector<Vec3> corners = {Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitZ()};
      for (std::size_t k = 0; k < points.size(); ++k) {
        EXPECT_LE((found.positions[k] / size - corners[k]).norm(), 1e-9);
        EXPECT_NEAR(found.distances[k] / points[k].stableNorm(), 1.0, 1e-9);
        EXPECT_TRUE(found.faces[k] >= 0 && found.faces[k] < 8);
      }
    }
}

TEST(Projector, FindsNoFaceAroundVeryFarPoints) {
  const Surface surface = octahedron().surface();
  const std::vector<Vec3> points = {{1e200, 0, 0}, {1e200, 0, 0}, {0, 0, 0}};
  const auto found = Projector(surface).faces_within(points, std::vector{1.0, 1e201, 1e200});
  EXPECT_TRUE(found[0].empty());
  EXPECT_EQ(found[1].size(), 8u);
  EXPECT_EQ(found[2].size(), 8u);
}

}  // namespace
}  // namespace dapple::test
