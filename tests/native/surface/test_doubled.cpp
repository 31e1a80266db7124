// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/decals.hpp>
#include <dapple/projector.hpp>
#include <dapple/refine.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <dapple/tracker.hpp>

#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// The faces of a shape again, each starting at another corner.
Shape doubled(Shape shape, bool turned, bool own_vertices) {
  const std::size_t faces = shape.faces.size();
  const auto first = static_cast<std::int32_t>(own_vertices ? shape.vertices.size() : 0);
  if (own_vertices) {
    const std::vector<Vec3> vertices = shape.vertices;
    shape.vertices.insert(shape.vertices.end(), vertices.begin(), vertices.end());
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const auto [a, b, c] = shape.faces[f];
    shape.faces.push_back(turned ? Face{first + b, first + a, first + c}
                                 : Face{first + b, first + c, first + a});
  }
  return shape;
}

std::vector<Shape> doubled_in_all_ways(const Shape& shape) {
  return {doubled(shape, false, false), doubled(shape, true, false), doubled(shape, false, true),
          doubled(shape, true, true)};
}

Surface kept(const Shape& shape) {
  return {shape.vertices, shape.faces, Density{}, {.merge_doubled = false}};
}

TEST(DoubledFaces, CountOnceHoweverTheyAreTurned) {
  const Surface single = box(4).surface();
  for (const Shape& shape : doubled_in_all_ways(box(4))) {
    const Surface surface = shape.surface();
    EXPECT_EQ(surface.doubled_faces(), single.face_count());
    EXPECT_EQ(surface.face_count(), 2 * single.face_count());
    EXPECT_DOUBLE_EQ(surface.area(), single.area());
    EXPECT_EQ(surface.faces(), shape.faces);
    EXPECT_EQ(surface.vertices(), shape.vertices);
    EXPECT_TRUE(topology(surface).closed);
    EXPECT_EQ(topology(surface).components, 1);
    EXPECT_DOUBLE_EQ(kept(shape).area(), 2.0 * single.area());
    EXPECT_EQ(kept(shape).doubled_faces(), 0u);
  }
}

TEST(DoubledFaces, HalfTheSamplesAreOnEachOfTwoCubes) {
  const auto away = [](const Vec3& p) { return Vec3(p + Vec3(3, 0, 0)); };
  for (const Shape& shape : doubled_in_all_ways(box(4))) {
    const Surface surface = joined(shape, mapped(box(4), away)).surface();
    const Samples samples = sample(surface, 1200);
    check(surface, samples);
    EXPECT_EQ(std::count_if(samples.positions.begin(), samples.positions.end(),
                            [](const Vec3& p) { return p.x() < 2.0; }),
              600);
  }
}

TEST(DoubledFaces, ADoubleSidedGroundIsAsEvenAsASingleOne) {
  const double single = sample(grid(20).surface(), 1000).report.bond_order;
  for (const Shape& shape : doubled_in_all_ways(grid(20))) {
    const Samples samples = sample(shape.surface(), 1000);
    EXPECT_NEAR(samples.report.bond_order, single, 0.03);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      EXPECT_LT(samples.faces[k], 800);
      EXPECT_GT(samples.normals[k].z(), 0.99);
    }
  }
}

TEST(DoubledFaces, AreNeverFoundByAProjection) {
  for (const Shape& shape : doubled_in_all_ways(grid(3))) {
    const Surface surface = shape.surface();
    Random random(1);
    const Sites sites = random_sites(grid(3), 100, random);
    const Projection found = Projector(surface).project(sites.positions);
    for (const std::int32_t face : found.faces) EXPECT_LT(face, 18);
  }
}

TEST(DoubledFaces, SamplesOnThemMoveToWhatTheyLieOn) {
  const Vec3 weights(0.2, 0.3, 0.5);
  for (const Shape& shape : doubled_in_all_ways(box(2))) {
    const Surface surface = shape.surface();
    const auto count = static_cast<std::int32_t>(surface.face_count());
    for (std::int32_t face = 0; face < count; ++face) {
      const Samples samples = bind_samples(surface, std::array{face}, std::array<Vec3, 1>{weights});
      EXPECT_EQ(samples.faces[0], face % (count / 2));
      EXPECT_LT((samples.positions[0] - shape.point(face, weights)).norm(), 1e-12);
      EXPECT_LT(
          (shape.point(samples.faces[0], samples.barycentric[0]) - samples.positions[0]).norm(),
          1e-12);
      EXPECT_NEAR(samples.normals[0].norm(), 1.0, 1e-12);
    }
  }
}

TEST(DoubledFaces, HaveTheDensityOfTheFirst) {
  Shape shape = doubled(grid(2), true, true);
  std::vector<double> density(shape.faces.size(), 1.0);
  std::fill(density.begin() + 8, density.end(), 5.0);
  const Surface surface(shape.vertices, shape.faces, Density{DensityAt::kFaces, density});
  EXPECT_DOUBLE_EQ(surface.capacity(), 1.0);
  EXPECT_EQ(surface.density(), density);
  std::reverse(density.begin(), density.end());
  EXPECT_DOUBLE_EQ(surface.with_density(Density{DensityAt::kFaces, density}).capacity(), 5.0);
}

TEST(DoubledFaces, CellsAreThoseOfTheSingleSurface) {
  Random random(2);
  const Sites sites = random_sites(box(3), 60, random);
  const RestrictedVoronoi single = restricted_voronoi(box(3).surface(), sites, Cells::kEuclidean);
  for (const Shape& shape : doubled_in_all_ways(box(3))) {
    Sites there = sites;
    // half of them lie on faces that do not count
    for (std::size_t k = 0; k < there.size(); k += 2) {
      there.faces[k] += static_cast<std::int32_t>(shape.faces.size() / 2);
      there.barycentric.clear();
    }
    const RestrictedVoronoi found = restricted_voronoi(shape.surface(), there, Cells::kEuclidean);
    for (std::size_t k = 0; k < sites.size(); ++k)
      EXPECT_NEAR(found.cells[k].area, single.cells[k].area, 1e-12);
  }
}

TEST(DoubledFaces, AreNotCutFiner) {
  for (const Shape& shape : doubled_in_all_ways(grid(2))) {
    const Surface surface = shape.surface();
    const Refined refined = refine_edges(surface, std::array{0.2}, 10000);
    for (const std::int32_t parent : refined.parents) EXPECT_LT(parent, 8);
    EXPECT_NEAR(refined.surface.area(), 1.0, 1e-12);
    EXPECT_EQ(refined.surface.doubled_faces(), 0u);
  }
}

TEST(DoubledFaces, AreDecidedAtRest) {
  const Shape shape = doubled(grid(4), true, true);
  const Surface surface = shape.surface();
  std::vector<Vec3> vertices = shape.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v].z() += v < 25 ? 0.0 : 1.0;
  EXPECT_EQ(surface.deformed(vertices).doubled_faces(), 32u);
  EXPECT_DOUBLE_EQ(surface.deformed(vertices).area(), 1.0);
}

TEST(DoubledFaces, OverlapsThatAreNotEqualStay) {
  const Shape shape{"Quads",
                    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}}};
  EXPECT_EQ(shape.surface().doubled_faces(), 0u);
  EXPECT_DOUBLE_EQ(shape.surface().area(), 2.0);
}

TEST(DoubledFaces, ThreeTimesTheSameFaceIsOne) {
  const Shape shape{"Thrice", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}}};
  EXPECT_EQ(shape.surface().doubled_faces(), 2u);
  EXPECT_DOUBLE_EQ(shape.surface().area(), 0.5);
  EXPECT_EQ(topology(shape.surface()).border_edges, 3);
}

}  // namespace
}  // namespace dapple::test
