// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/analysis.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

Evenness evenness(const Surface& surface, const Sites& sites) {
  return measure_evenness(restricted_voronoi(surface, sites, Cells::kEuclidean));
}

/// A sheet that fits whole hexagons in offset rows, so that the mean cell has the area of a
/// hexagon.
TEST(Analysis, OfHexagonsIsOne) {
  const int columns = 12, rows = 10;
  const double height = rows * std::numbers::sqrt3 / 2.0;
  const Shape sheet =
      mapped(grid(1), [&](const Vec3& p) { return Vec3(columns * p.x(), height * p.y(), 0.0); });
  Sites sites;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec3 p(column + 0.25 + 0.5 * (row % 2), (row + 0.5) * std::numbers::sqrt3 / 2.0, 0.0);
      sites.positions.push_back(p);
      sites.faces.push_back(p.y() / height > p.x() / columns ? 1 : 0);
    }
  const Evenness found = evenness(sheet.surface(), sites);
  EXPECT_NEAR(found.alpha_min, 1.0, 1e-12);
  EXPECT_NEAR(found.alpha_mean, 1.0, 1e-12);
  EXPECT_LT(found.capacity_variation, 0.2);
}

/// Sites in rows of a sheet of unit squares, odd rows shifted by `shift`.
struct Rows {
  Shape sheet;
  Sites sites;
};

Rows rows_of(int columns, int rows, double distance, double shift) {
  const double height = rows * distance;
  Rows result;
  result.sheet =
      mapped(grid(1), [&](const Vec3& p) { return Vec3(columns * p.x(), height * p.y(), 0.0); });
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec3 p(column + 0.25 + shift * (row % 2), (row + 0.5) * distance, 0.0);
      result.sites.positions.push_back(p);
      result.sites.faces.push_back(p.y() / height > p.x() / columns ? 1 : 0);
    }
  return result;
}

double order_of(const Shape& shape, const Sites& sites) {
  const Surface surface = shape.surface();
  const RestrictedVoronoi diagram = restricted_voronoi(surface, sites, Cells::kEuclidean);
  std::vector<Vec3> normals;
  for (const std::int32_t face : sites.faces)
    normals.push_back(surface.ordered().geometry(surface.ordered().ordered_face(face)).normal);
  return bond_order(diagram, normals, cells_on_border(surface, sites, diagram));
}

TEST(BondOrder, OfHexagonsIsOneAndOfSquaresZero) {
  const Rows hexagons = rows_of(12, 10, std::numbers::sqrt3 / 2.0, 0.5);
  EXPECT_NEAR(order_of(hexagons.sheet, hexagons.sites), 1.0, 1e-9);
  const Rows squares = rows_of(9, 9, 1.0, 0.0);
  EXPECT_NEAR(order_of(squares.sheet, squares.sites), 0.0, 1e-9);
}

TEST(BondOrder, IsTheSameWhateverTheDirection) {
  const Shape shape = grid(6);
  Random random(9);
  const Sites sites = random_sites(shape, 200, random);
  const double flat = order_of(shape, sites);
  const auto turn = [](const Vec3& p) { return rotated(p, 1.1); };
  Sites turned = sites;
  for (Vec3& p : turned.positions) p = turn(p);
  EXPECT_NEAR(order_of(mapped(shape, turn), turned), flat, 1e-9);
}

/// The expected value 0.360 comes from a planar Delaunay triangulation (Qhull) of 50,000 points;
/// here there are 10,000 sites, each with a standard deviation of 0.17.
TEST(BondOrder, OfWhiteNoiseIsThatOfThePlane) {
  const Shape shape = icosphere(5);
  Random random(6);
  EXPECT_NEAR(order_of(shape, random_sites(shape, 10000, random)), 0.360, 0.006);
}

TEST(BondOrder, IsReported) {
  const Surface surface = torus(60, 24).surface();
  const Samples samples = sample(surface, 1500);
  EXPECT_GT(samples.report.bond_order, 0.40);
  EXPECT_LT(samples.report.bond_order, 0.60);
  const Report again = analyze(surface, samples);
  EXPECT_EQ(again.count, 1500u);
  EXPECT_EQ(again.spacing, samples.report.spacing);
  EXPECT_NEAR(again.bond_order, samples.report.bond_order, 1e-6);
  EXPECT_NEAR(again.evenness.alpha_min, samples.report.evenness.alpha_min, 1e-9);
  EXPECT_NEAR(again.evenness.capacity_variation, samples.report.evenness.capacity_variation, 1e-9);
  EXPECT_NEAR(again.energy, samples.report.energy, 1e-9);
}

/// A face without area has no normal, and its sites have no tangent plane.
TEST(BondOrder, LeavesOutSitesWithoutANormal) {
  const Surface surface = blob(3).surface();
  const Samples samples = sample(surface, 100);
  const RestrictedVoronoi diagram = restricted_voronoi(
      surface, {samples.positions, samples.faces, samples.barycentric}, Cells::kEuclidean);
  std::vector<Vec3> normals = samples.normals;
  std::vector<bool> left_out(100, false);
  normals[17] = Vec3::Zero();
  left_out[17] = true;
  EXPECT_EQ(bond_order(diagram, normals), bond_order(diagram, samples.normals, left_out));
}

TEST(BondOrder, OfNoneAndFewIsZero) {
  const Shape shape = grid(3);
  Random random(3);
  for (const std::size_t count : {0u, 1u, 2u, 3u})
    EXPECT_EQ(order_of(shape, random_sites(shape, count, random)), 0.0);
}

TEST(BondOrder, IsFiniteForDegenerateSites) {
  Random random(13);
  for (const Shape& shape : all_shapes()) {
    const double order = order_of(shape, degenerate_sites(shape, 60, random));
    EXPECT_GE(order, 0.0) << shape.name;
    EXPECT_LE(order, 1.0 + 1e-12) << shape.name;
  }
}

/// Compare with the pieces of cells that have an edge on a border of the surface.
std::vector<bool> with_a_piece_on_the_border(const Surface& surface, const Sites& sites,
                                             Cells cells) {
  std::vector<bool> result(sites.size(), false);
  for (const CellPolygon& piece : restricted_voronoi_polygons(surface, sites, cells))
    for (std::size_t k = 0; k < piece.points.size(); ++k) {
      if (piece.edges[k] >= 0) continue;
      const std::int32_t h =
          half_edge(surface.ordered().ordered_face(piece.face), -1 - piece.edges[k]);
      const Vec3 side = piece.points[(k + 1) % piece.points.size()] - piece.points[k];
      if (surface.ordered().next_around(h) == h && side.norm() > 1e-9)
        result[static_cast<std::size_t>(piece.site)] = true;
    }
  return result;
}

TEST(CellsOnBorder, AreThoseWithAPieceThere) {
  Random random(14);
  for (const Shape& shape : {grid(4), tube(24, 6), moebius(40), torus(20, 10), two_sheets(6, 0.02)})
    for (const std::size_t count : {1u, 5u, 60u, 300u}) {
      const Surface surface = shape.surface();
      const Sites sites = random_sites(shape, count, random);
      const RestrictedVoronoi diagram = restricted_voronoi(surface, sites, Cells::kConnected);
      EXPECT_EQ(cells_on_border(surface, sites, diagram),
                with_a_piece_on_the_border(surface, sites, Cells::kConnected))
          << shape.name << ' ' << count;
    }
}

/// In the plane the cell of the nearest site is always adjacent.
TEST(Analysis, AgreesWithBruteForceInThePlane) {
  const Shape shape = grid(5);
  const Surface surface = shape.surface();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Sites sites = random_sites(shape, 60, random);
    const RestrictedVoronoi diagram = restricted_voronoi(surface, sites, Cells::kEuclidean);
    double least = 1e9, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      double nearest = 1e9;
      for (std::size_t j = 0; j < sites.size(); ++j)
        if (i != j) nearest = std::min(nearest, (sites.positions[i] - sites.positions[j]).norm());
      least = std::min(least, nearest);
      sum += nearest;
      squares += std::pow(diagram.cells[i].capacity - 1.0 / 60.0, 2);
    }
    const Evenness found = measure_evenness(diagram);
    EXPECT_NEAR(found.alpha_min, least / surface.spacing(60), 1e-12);
    EXPECT_NEAR(found.alpha_mean, sum / 60.0 / surface.spacing(60), 1e-12);
    EXPECT_NEAR(found.capacity_variation, std::sqrt(squares / 60.0) * 60.0, 1e-12);
  }
}

TEST(Analysis, IsTheSameForAnyConstantDensity) {
  const Shape shape = blob(2);
  Random random(2);
  const Sites sites = random_sites(shape, 50, random);
  const Evenness plain = evenness(shape.surface(), sites);
  const Evenness dense =
      evenness(with_density(shape, [](const Vec3&) { return 7.0; }).surface(), sites);
  EXPECT_NEAR(plain.alpha_min, dense.alpha_min, 1e-12);
  EXPECT_NEAR(plain.alpha_mean, dense.alpha_mean, 1e-12);
  EXPECT_NEAR(plain.capacity_variation, dense.capacity_variation, 1e-12);
}

/// Relative to their local spacing, samples of a varying density are as even as samples of a
/// constant one.
TEST(Analysis, MeasuresAgainstTheLocalSpacing) {
  const Surface surface =
      with_density(grid(10), [](const Vec3& p) { return 0.2 + 3.0 * p.x(); }).surface();
  const Evenness found = sample(surface, 500).report.evenness;
  EXPECT_GT(found.alpha_mean, 0.78);
  EXPECT_LT(found.alpha_mean, 0.92);
}

TEST(Analysis, OfCoincidentSitesIsZero) {
  const Shape shape = grid(3);
  Random random(3);
  Sites sites = random_sites(shape, 10, random);
  sites.positions[7] = sites.positions[2];
  sites.faces[7] = sites.faces[2];
  EXPECT_EQ(evenness(shape.surface(), sites).alpha_min, 0.0);
}

TEST(Analysis, OfNoneAndOneIsFinite) {
  const Shape shape = grid(3);
  Random random(3);
  for (const std::size_t count : {0u, 1u}) {
    const Evenness found = evenness(shape.surface(), random_sites(shape, count, random));
    EXPECT_TRUE(std::isfinite(found.alpha_min));
    EXPECT_TRUE(std::isfinite(found.alpha_mean));
    EXPECT_NEAR(found.capacity_variation, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace dapple::test
