// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/restricted_voronoi.hpp>
#include <set>

#include "remesh/cells_along.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

double area_of(const CellPolygon& piece) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < piece.points.size(); ++k)
    sum += (piece.points[k - 1] - piece.points[0]).cross(piece.points[k] - piece.points[0]);
  return 0.5 * sum.norm();
}

/// The area of each site's cell.
std::vector<double> areas_of(std::span<const CellPolygon> pieces, std::size_t sites) {
  std::vector<double> areas(sites, 0.0);
  for (const CellPolygon& piece : pieces)
    areas[static_cast<std::size_t>(piece.site)] += area_of(piece);
  return areas;
}

/// A site on each face whose number is a multiple.
Sites sites_on(const Surface& surface, std::int32_t step) {
  Sites sites;
  Random random(3);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); f += step) {
    const double a = random.between(0.1, 0.4), b = random.between(0.1, 0.4);
    const Vec3 weights(a, b, 1.0 - a - b);
    sites.positions.push_back(surface.point(f, weights));
    sites.faces.push_back(f);
    sites.barycentric.push_back(weights);
  }
  return sites;
}

TEST(CellsAlong, AreThoseInSpaceOnAFlatSurface) {
  const Surface surface = grid(12).surface();
  const Sites sites = sites_on(surface, 23);
  const std::vector<double> along = areas_of(CellsAlong(surface).polygons(sites), sites.size());
  const std::vector<double> space =
      areas_of(restricted_voronoi_polygons(surface, sites), sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) EXPECT_NEAR(along[k], space[k], 1e-6) << k;
}

/// A sheet folded over, a hundredth of its width apart.
Shape folded_sheet() {
  return mapped(grid(24), [](const Vec3& p) {
    const double s = 2.0 * p[0] - 1.0;
    return Vec3(std::abs(s), p[1], s < 0.0 ? 0.01 : 0.0);
  });
}

TEST(CellsAlong, DoNotReachThroughAGap) {
  const Shape shape = folded_sheet();
  const Surface surface = shape.surface();
  Sites sites;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f) {
    const Vec3 middle = surface.point(f, Vec3::Constant(1.0 / 3.0));
    if (middle[0] < 0.5 || f % 29 > 0) continue;  // none near the fold
    sites.positions.push_back(middle);
    sites.faces.push_back(f);
    sites.barycentric.push_back(Vec3::Constant(1.0 / 3.0));
  }
  double total = 0.0;
  for (const CellPolygon& piece : CellsAlong(surface).polygons(sites)) {
    total += area_of(piece);
    const Vec3& site = sites.positions[static_cast<std::size_t>(piece.site)];
    for (const Vec3& p : piece.points)
      if (p[0] > 0.1) {
        EXPECT_NEAR(p[2], site[2], 1e-9);
      }
  }
  EXPECT_NEAR(total, surface.area(), 1e-9);
}

TEST(CellsAlong, APartWithoutSitesBelongsToTheNearest) {
  const Shape beside = mapped(grid(4), [](const Vec3& p) { return Vec3(p + Vec3(2, 0, 0)); });
  const Surface surface = joined(grid(4), beside).surface();
  const Sites sites = sites_on(surface, 7);
  Sites left;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (sites.positions[k][0] > 1.0) continue;
    left.positions.push_back(sites.positions[k]);
    left.faces.push_back(sites.faces[k]);
    left.barycentric.push_back(sites.barycentric[k]);
  }
  std::set<std::int32_t> owners;
  double total = 0.0;
  for (const CellPolygon& piece : CellsAlong(surface).polygons(left)) {
    total += area_of(piece);
    if (piece.points[0][0] >= 2.0) owners.insert(piece.site);
  }
  EXPECT_EQ(owners.size(), 1u);
  EXPECT_NEAR(total, 2.0, 1e-9);
}

/// A strip of faces hundreds of times longer than wide, leaning to both sides.
Shape needles() {
  return mapped(grid(100), [](const Vec3& p) {
    return Vec3(p[0] + 0.3 * std::sin(40.0 * p[1]), 1e-3 * p[1], 0.05 * std::sin(7.0 * p[0]));
  });
}

TEST(CellsAlong, NeedlesAreDividedAtOnce) {
  const Surface surface = needles().surface();
  const Sites sites = sites_on(surface, 611);
  double total = 0.0;
  for (const double area : areas_of(CellsAlong(surface).polygons(sites), sites.size())) {
    EXPECT_GT(area, 0.0);
    total += area;
  }
  EXPECT_NEAR(total, surface.area(), 1e-9);
}

TEST(CellsAlong, WithoutSitesThereAreNone) {
  EXPECT_TRUE(CellsAlong(grid(2).surface()).polygons(Sites()).empty());
}

}  // namespace
}  // namespace dapple::test
