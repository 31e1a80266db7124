// SPDX-License-Identifier: GPL-3.0-or-later
#include "expect.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <dapple/domain.hpp>
#include <limits>

namespace dapple::fuzz {
namespace {

template <typename T>
bool equal(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool equal(const std::vector<Tile>& a, const std::vector<Tile>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Tile& s, const Tile& t) {
    return s.cell_area == t.cell_area && s.area == t.area && s.parts == t.parts &&
           s.loops == t.loops;
  });
}

/// How much larger faces can be with their welded vertices in place of their own: tiles have those.
double area_by_welding(const Surface& surface) {
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<Face> faces = surface.faces(), welded = surface.welded_faces();
  const auto at = [&](std::int32_t v) { return vertices[static_cast<std::size_t>(v)]; };
  double result = 0.0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double moved = 0.0, around = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      moved += (at(faces[f][k]) - at(welded[f][k])).stableNorm();
      around += (at(faces[f][(k + 1) % 3]) - at(faces[f][k])).stableNorm();
    }
    result += moved * (around + moved);
  }
  return result;
}

}  // namespace

bool same_bytes(const Samples& a, const Samples& b) {
  return test::same_bytes(a, b) && equal(a.fade, b.fade) &&
         a.report.slide_max == b.report.slide_max;
}

bool same_bytes(const std::vector<Samples>& a, const std::vector<Samples>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Samples& s, const Samples& t) { return same_bytes(s, t); });
}

bool same_bytes(const PlanarSamples& a, const PlanarSamples& b) {
  return equal(a.positions, b.positions) && equal(a.classes, b.classes) &&
         equal(a.report.energies, b.report.energies);
}

bool same_bytes(const Mosaic& a, const Mosaic& b) {
  return equal(a.vertices, b.vertices) && equal(a.corners, b.corners) &&
         equal(a.starts, b.starts) && equal(a.sites, b.sites) && equal(a.classes, b.classes) &&
         equal(a.faces, b.faces) && equal(a.sides, b.sides) && equal(a.tiles, b.tiles);
}

bool same_bytes(const RemeshResult& a, const RemeshResult& b) {
  return equal(a.vertices, b.vertices) && a.faces == b.faces && a.lines == b.lines &&
         equal(a.source_faces, b.source_faces) && equal(a.barycentric, b.barycentric) &&
         equal(a.density, b.density);
}

bool same_bytes(const NextRemesh& a, const NextRemesh& b) {
  return same_bytes(a.mesh, b.mesh) && a.previous == b.previous && a.kept == b.kept;
}

bool same_bytes(const Stipples& a, const Stipples& b) {
  return equal(a.positions, b.positions) && equal(a.classes, b.classes) && a.radius == b.radius;
}

bool same_bytes(const Refined& a, const Refined& b) {
  return a.parents == b.parents && a.ends == b.ends && a.surface.faces() == b.surface.faces() &&
         test::same_bytes(a.surface.vertices(), b.surface.vertices()) &&
         equal(a.surface.density(), b.surface.density());
}

void expect_where_dense(const Surface& surface, const Samples& samples,
                        std::span<const std::int32_t> locked) {
  test::check_where_dense(surface, samples, locked);
}

void expect_filled(const Surface& surface, const Samples& samples, Cells cells,
                   std::span<const std::int32_t> locked) {
  if (!samples.report.converged) return;
  const Sites sites{samples.positions, samples.faces, samples.barycentric};
  const RestrictedVoronoi diagram = SurfaceDomain(surface, cells).cells(sites, nullptr);
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (std::find(locked.begin(), locked.end(), samples.ids[k]) == locked.end()) {
      EXPECT_GT(diagram.cells[k].capacity, 0.0) << "sample " << k << " is converged without a cell";
    }
}

double area_rounding(const Surface& surface) {
  const std::vector<Vec3> vertices = surface.vertices();
  double largest = 0.0, edges = 0.0;
  for (const Face& face : surface.faces())
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& a = vertices[static_cast<std::size_t>(face[k])];
      edges += (vertices[static_cast<std::size_t>(face[(k + 1) % 3])] - a).stableNorm();
      largest = std::max(largest, a.cwiseAbs().maxCoeff());
    }
  return 64.0 * std::numeric_limits<double>::epsilon() * largest * edges;
}

void expect_valid(const Surface& surface, const Samples& samples) {
  test::check(surface, samples, area_rounding(surface));
  expect_measured(samples.report);
}

void expect_samples(const Surface& surface, const Samples& samples, std::size_t count) {
  EXPECT_EQ(samples.size(), count);
  expect_valid(surface, samples);
  expect_where_dense(surface, samples);
}

void expect_descent(const Report& report) {
  for (std::size_t k = 0; k < report.energies.size(); ++k) {
    EXPECT_TRUE(std::isfinite(report.energies[k])) << "energies[" << k << "]";
    if (k > 0) {
      EXPECT_LE(report.energies[k], report.energies[k - 1]) << "energies[" << k << "]";
    }
  }
}

void expect_measured(const Report& report) {
  EXPECT_TRUE(std::isfinite(report.energy)) << report.energy;
  EXPECT_TRUE(std::isfinite(report.spacing)) << report.spacing;
  EXPECT_TRUE(std::isfinite(report.evenness.capacity_variation));
  EXPECT_GE(report.evenness.alpha_min, 0.0);
  EXPECT_LE(report.evenness.alpha_min, report.evenness.alpha_mean * (1.0 + 1e-9));
  EXPECT_GE(report.bond_order, 0.0);
  EXPECT_LE(report.bond_order, 1.0 + 1e-9);
}

std::size_t count_of(std::span<const std::int32_t> classes, std::int32_t wanted) {
  return static_cast<std::size_t>(std::count(classes.begin(), classes.end(), wanted));
}

void expect_mosaic(const Surface& surface, const Mosaic& mosaic, std::size_t count,
                   double tolerance) {
  const auto vertices = static_cast<std::int32_t>(mosaic.vertices.size());
  EXPECT_EQ(mosaic.tiles.size(), count);
  ASSERT_EQ(mosaic.starts.size(), mosaic.size() + 1);
  ASSERT_EQ(mosaic.starts.back(), static_cast<std::int32_t>(mosaic.corners.size()));
  for (std::size_t k = 0; k < mosaic.size(); ++k) {
    EXPECT_GE(mosaic.starts[k + 1] - mosaic.starts[k], 3) << "polygon " << k;
    EXPECT_LT(static_cast<std::size_t>(mosaic.sites[k]), count);
    EXPECT_LT(static_cast<std::size_t>(mosaic.faces[k]), surface.face_count());
    if (k > 0) {
      EXPECT_LE(mosaic.sites[k - 1], mosaic.sites[k]);
    }
  }
  for (const std::int32_t v : mosaic.corners) {
    EXPECT_GE(v, 0);
    EXPECT_LT(v, vertices);
  }
  for (const Vec3& vertex : mosaic.vertices) EXPECT_TRUE(vertex.allFinite());
  const double rounding = 1e-9 * surface.area() + area_rounding(surface);
  const double welding = area_by_welding(surface);
  double cells = 0.0;
  for (const Tile& tile : mosaic.tiles) {
    EXPECT_GE(tile.area, 0.0);
    if (tolerance == 0.0) {
      EXPECT_LE(tile.area, tile.cell_area + rounding + welding);
    }
    cells += tile.cell_area;
  }
  if (count > 0) {
    EXPECT_NEAR(cells, surface.area(), rounding);
  }
}

}  // namespace dapple::fuzz
