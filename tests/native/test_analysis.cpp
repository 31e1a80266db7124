// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/analysis.hpp>
#include <dapple/sampler.hpp>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

Evenness evenness(const Surface& surface, const Sites& sites) {
  return measure_evenness(restricted_voronoi(surface, sites));
}

/// A sheet as wide and high as whole hexagons in offset rows, so that the mean cell is a hexagon's
/// area.
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
  EXPECT_LT(found.capacity_spread, 0.2);
}

/// In the plane the nearest site is always one whose cell touches.
TEST(Analysis, AgreesWithBruteForceInThePlane) {
  const Shape shape = grid(5);
  const Surface surface = shape.surface();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const Sites sites = random_sites(shape, 60, random);
    const RestrictedVoronoi diagram = restricted_voronoi(surface, sites);
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
    EXPECT_NEAR(found.capacity_spread, std::sqrt(squares / 60.0) * 60.0, 1e-12);
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
  EXPECT_NEAR(plain.capacity_spread, dense.capacity_spread, 1e-12);
}

/// Samples that follow a density are as even, each against its own spacing, as samples of a
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
    EXPECT_NEAR(found.capacity_spread, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace dapple::test
