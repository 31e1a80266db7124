// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <limits>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

Vec3 face_normal(const Shape& shape, std::size_t f) {
  const auto [a, b, c] = shape.faces[f];
  const auto vertex = [&](std::int32_t v) { return shape.vertices[static_cast<std::size_t>(v)]; };
  return (vertex(b) - vertex(a)).cross(vertex(c) - vertex(a)).normalized();
}

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

/// The largest angle between the normals at corners and those of their faces.
double most_from_faces(const Shape& shape, const Surface& surface) {
  const std::vector<Vec3> normals = surface.corner_normals();
  double most = 0.0;
  for (std::size_t k = 0; k < normals.size(); ++k)
    most = std::max(most, degrees_between(normals[k], face_normal(shape, k / 3)));
  return most;
}

/// An upright prism with `sides` sides and caps, whose vertices are shared.
Shape prism(int sides) {
  Shape shape{.name = "prism", .vertices = {}, .faces = {}};
  for (int z = 0; z < 2; ++z)
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides;
      shape.vertices.emplace_back(std::cos(angle), std::sin(angle), z);
    }
  for (int k = 0; k < sides; ++k) {
    const int next = (k + 1) % sides;
    shape.faces.push_back({k, next, sides + next});
    shape.faces.push_back({k, sides + next, sides + k});
    if (k > 0 && next > 0) {
      shape.faces.push_back({0, next, k});
      shape.faces.push_back({sides, sides + k, sides + next});
    }
  }
  return shape;
}

TEST(CornerNormals, StandsUprightOnTheFacesOfACube) {
  for (const Shape& shape : {box(1), box(4), soup(box(4)), split_edges(box(4), 30.0)})
    EXPECT_LE(most_from_faces(shape, shape.surface()), 1e-6) << shape.name;
}

TEST(CornerNormals, IsRoundOnTheSideOfACylinderAndFlatOnItsCaps) {
  const Shape shape = prism(12);  // adjacent sides differ by exactly 30 degrees
  const std::vector<Vec3> normals = shape.surface().corner_normals();
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const Vec3& v = shape.vertices[static_cast<std::size_t>(shape.faces[k / 3][k % 3])];
    const bool cap = std::abs(face_normal(shape, k / 3).z()) > 0.5;
    const Vec3 ideal = cap ? Vec3(0, 0, v.z() > 0.5 ? 1 : -1) : Vec3(v.x(), v.y(), 0.0);
    EXPECT_LE(degrees_between(normals[k], ideal), cap ? 1e-6 : 8.0) << "corner " << k;
  }
}

TEST(CornerNormals, TakesTheAngleThatIsAskedFor) {
  const Shape shape = prism(12);
  const Surface flat(shape.vertices, shape.faces, {}, {.sharp_angle = 29.0});
  const Surface smooth(shape.vertices, shape.faces, {}, {.sharp_angle = 180.0});
  EXPECT_LE(most_from_faces(shape, flat), 1e-6);
  EXPECT_GT(most_from_faces(shape, smooth), 40.0);
  EXPECT_EQ(flat.sharp_angle(), 29.0);
}

TEST(CornerNormals, IgnoresSplitVertices) {
  for (const Shape& shape : {blob(3), icosphere(2), torus(24, 12), tube(30, 4), tee(4), fin(3)}) {
    const std::vector<Vec3> one = shape.surface().corner_normals();
    const std::vector<Vec3> other = soup(shape).surface().corner_normals();
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_LE((one[k] - other[k]).norm(), 1e-9) << shape.name << " corner " << k;
  }
}

/// The same points are judged on welded and on split vertices.
TEST(CornerNormals, JudgesSamplesAlikeOnWeldedAndSplitVertices) {
  for (const Shape& shape : {box(6), prism(40), blob(3)}) {
    const Samples samples = sample(shape.surface(), 300);
    const Report one = analyze(shape.surface(), samples);
    for (const Shape& other : {split_edges(shape, 30.0), soup(shape)}) {
      const Surface surface = other.surface();
      const Samples bound = bind_samples(surface, samples.faces, samples.barycentric);
      const Report report = analyze(surface, bound);
      EXPECT_NEAR(report.bond_order, one.bond_order, 1e-6) << shape.name;
      EXPECT_NEAR(report.evenness.alpha_min, one.evenness.alpha_min, 1e-6) << shape.name;
      EXPECT_NEAR(report.evenness.capacity_variation, one.evenness.capacity_variation, 1e-6)
          << shape.name;
    }
  }
}

TEST(CornerNormals, JumpsBetweenFacesThatAreOrientedAgainstEachOther) {
  Shape shape = grid(4);
  std::swap(shape.faces[7][1], shape.faces[7][2]);
  EXPECT_LE(most_from_faces(shape, shape.surface()), 1e-6);
}

TEST(CornerNormals, GoesThroughFacesWithoutAreaWhereTheSurfaceIsSmooth) {
  Shape shape = icosphere(2);  // a sliver on the first edge, between two faces
  const auto [a, b, c] = shape.faces[0];
  const std::vector<Vec3> before = shape.surface().corner_normals();
  const auto middle = static_cast<std::int32_t>(shape.vertices.size());
  shape.vertices.push_back(0.5 * (shape.vertices[static_cast<std::size_t>(a)] +
                                  shape.vertices[static_cast<std::size_t>(b)]));
  shape.faces[0] = {a, middle, c};
  shape.faces.push_back({middle, b, c});
  shape.faces.push_back({a, b, middle});
  const std::vector<Vec3> after = shape.surface().corner_normals();
  for (std::size_t k = 3; k < before.size(); ++k)
    EXPECT_LE(degrees_between(before[k], after[k]), 1e-5) << "corner " << k;
}

TEST(CornerNormals, StopsAtFacesWithoutAreaOnAHardEdge) {
  Shape shape = box(1);
  const auto [a, b, c] = shape.faces[0];
  const auto middle = static_cast<std::int32_t>(shape.vertices.size());
  shape.vertices.push_back(0.5 * (shape.vertices[static_cast<std::size_t>(a)] +
                                  shape.vertices[static_cast<std::size_t>(b)]));
  shape.faces[0] = {a, middle, c};
  shape.faces.push_back({middle, b, c});
  const std::size_t proper = shape.faces.size();
  shape.faces.push_back({a, b, middle});
  const std::vector<Vec3> normals = shape.surface().corner_normals();
  for (std::size_t k = 0; k < 3 * proper; ++k)
    EXPECT_LE(degrees_between(normals[k], face_normal(shape, k / 3)), 1e-6) << "corner " << k;
}

std::vector<Vec3> leaning_normals(const Shape& shape) {
  std::vector<Vec3> result;
  for (const Face& face : shape.faces)
    for (const std::int32_t v : face)
      result.emplace_back(2.0 * shape.vertices[static_cast<std::size_t>(v)] + Vec3(0, 0, 3));
  return result;
}

TEST(CornerNormals, TakesTheNormalsThatAreGiven) {
  const Shape shape = box(2);
  const std::vector<Vec3> given = leaning_normals(shape);
  const Surface surface = shape.surface().with_normals(given);
  EXPECT_TRUE(surface.has_normals());
  const std::vector<Vec3> found = surface.corner_normals();
  for (std::size_t k = 0; k < given.size(); ++k)
    EXPECT_LE((found[k] - given[k].normalized()).norm(), 1e-15);
  const Samples samples = sample(surface, 50);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Vec3 mean = Vec3::Zero();
    for (Eigen::Index c = 0; c < 3; ++c)
      mean += samples.barycentric[k][c] *
              found[3 * static_cast<std::size_t>(samples.faces[k]) + static_cast<std::size_t>(c)];
    EXPECT_LE((samples.normals[k] - mean.normalized()).norm(), 1e-12);
  }
}

TEST(CornerNormals, FindsTheNormalsThatAreNotGiven) {
  const Shape shape = box(2);
  std::vector<Vec3> given = leaning_normals(shape);
  for (std::size_t k = 0; k < given.size(); k += 2) given[k] = Vec3::Zero();
  const std::vector<Vec3> found = shape.surface().with_normals(given).corner_normals();
  for (std::size_t k = 0; k < given.size(); ++k)
    EXPECT_LE((found[k] - (k % 2 ? given[k].normalized() : face_normal(shape, k / 3))).norm(),
              1e-12)
        << "corner " << k;
}

TEST(CornerNormals, KeepsHardEdgesOfWhatIsDeformed) {
  const Shape shape = box(3);
  const auto flattened = [](const Vec3& p) {
    return Vec3(p.x() + 0.9 * p.z(), p.y(), 0.1 * p.z());
  };
  const Shape after = mapped(shape, flattened);
  EXPECT_LE(most_from_faces(after, shape.surface().deformed(after.vertices)), 1e-6);
  // A surface bent by far more than the angle stays smooth if its faces differ little.
  const Shape sheet = grid(8);
  const Shape bent = mapped(sheet, [](const Vec3& p) {
    return Vec3(p.x() < 0.5 ? p.x() : 0.5, p.y(), p.x() < 0.5 ? 0.0 : p.x() - 0.5);
  });
  EXPECT_GT(most_from_faces(bent, sheet.surface().deformed(bent.vertices)), 30.0);
}

TEST(CornerNormals, KeepsThePlacesWhereGivenNormalsJump) {
  const Shape shape = prism(12);
  std::vector<Vec3> flat;
  for (std::size_t k = 0; k < 3 * shape.faces.size(); ++k)
    flat.push_back(face_normal(shape, k / 3));
  const Shape taller = mapped(shape, [](const Vec3& p) { return Vec3(p.x(), p.y(), 2.0 * p.z()); });
  const Surface moved = shape.surface().with_normals(flat).deformed(taller.vertices);
  EXPECT_FALSE(moved.has_normals());
  EXPECT_LE(most_from_faces(taller, moved), 1e-6);
}

TEST(CornerNormals, IsKeptWhereNothingMoves) {
  const Shape shape = box(2);
  const Surface surface = shape.surface().with_normals(leaning_normals(shape));
  EXPECT_TRUE(surface.deformed(shape.vertices).has_normals());
  EXPECT_TRUE(
      same_bytes(surface.deformed(shape.vertices).corner_normals(), surface.corner_normals()));
  std::vector<Vec3> moved = shape.vertices;
  moved.back().y() += 1e-9;
  EXPECT_FALSE(surface.deformed(moved).has_normals());
}

TEST(CornerNormals, IsKeptWithAnotherDensity) {
  const Shape shape = box(2);
  const Surface surface = shape.surface().with_normals(leaning_normals(shape));
  const std::vector<double> density(shape.vertices.size(), 2.0);
  EXPECT_TRUE(same_bytes(surface.with_density({DensityAt::kVertices, density}).corner_normals(),
                         surface.corner_normals()));
}

TEST(CornerNormals, RefusesNormalsThatDoNotFit) {
  const Surface surface = box(1).surface();
  std::vector<Vec3> normals(36, Vec3::UnitX());
  normals[7].y() = std::numeric_limits<double>::quiet_NaN();
  expect_message<SurfaceError>([&] { (void)surface.with_normals(normals); },
                               {"normals[7]", "not finite"});
  normals.resize(12);
  expect_message<SurfaceError>([&] { (void)surface.with_normals(normals); }, {"12", "36"});
}

TEST(CornerNormals, RefusesAnAngleOutOfRange) {
  const Shape shape = box(1);
  for (const double angle : {-1.0, 180.5, std::numeric_limits<double>::quiet_NaN()})
    expect_message<SurfaceError>(
        [&] { (void)Surface(shape.vertices, shape.faces, {}, {.sharp_angle = angle}); },
        {"sharp_angle", "0..180"});
}

}  // namespace
}  // namespace dapple::test
