// SPDX-License-Identifier: GPL-3.0-or-later
// The restricted cells against cells cut in exact arithmetic. For each site its neighbors come
// from CGAL's exact Delaunay triangulation of the sites in space, and each face is clipped by the
// exact bisectors with them: a point is in a Voronoi cell if it is no farther from the site than
// from its Delaunay neighbors.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/restricted_voronoi.hpp>
#include <map>

#include "shapes.hpp"

namespace dapple::test {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Number = Kernel::FT;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<std::size_t, Kernel>;
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase>>;

constexpr int kMeshes = 120;

Point exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// Insert the sites; the first of coincident sites stays.
Delaunay triangulate(const std::vector<Vec3>& sites) {
  Delaunay result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const std::size_t before = result.number_of_vertices();
    const auto vertex = result.insert(exact(sites[k]));
    if (result.number_of_vertices() > before) vertex->info() = k;
  }
  return result;
}

/// The part of a convex polygon that is no farther from `site` than from `other`.
std::vector<Point> clip(const std::vector<Point>& polygon, const Point& site, const Point& other) {
  const Vector across = other - site;
  const Point middle = CGAL::midpoint(site, other);
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const Number dp = (middle - p) * across, dq = (middle - q) * across;
    if (dp >= 0) kept.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) kept.push_back(p + (dp / (dp - dq)) * (q - p));
  }
  return kept;
}

double area(const std::vector<Point>& polygon) {
  Vector sum(0, 0, 0);
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
    sum = sum + CGAL::cross_product(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
  return 0.5 * std::sqrt(CGAL::to_double(sum.squared_length()));
}

double cell_area(const Shape& shape, const Delaunay& delaunay, Delaunay::Vertex_handle site) {
  std::vector<Delaunay::Vertex_handle> neighbors;
  delaunay.finite_adjacent_vertices(site, std::back_inserter(neighbors));
  const std::vector<bool> counts = shape.counted();
  double sum = 0.0;
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    if (!counts[f]) continue;
    std::vector<Point> polygon;
    for (const std::int32_t v : shape.faces[f])
      polygon.push_back(exact(shape.vertices[static_cast<std::size_t>(v)]));
    for (const auto& neighbor : neighbors)
      polygon = clip(polygon, site->point(), neighbor->point());
    sum += area(polygon);
  }
  return sum;
}

/// The areas of all cells, 0 for the later ones of coincident sites.
std::vector<double> exact_areas(const Shape& shape, const std::vector<Vec3>& sites) {
  const Delaunay delaunay = triangulate(sites);
  std::vector<double> areas(sites.size(), 0.0);
  for (auto v = delaunay.finite_vertices_begin(); v != delaunay.finite_vertices_end(); ++v)
    areas[v->info()] = cell_area(shape, delaunay, v);
  return areas;
}

void expect_exact_areas(const Shape& shape, const Sites& sites) {
  const Surface surface = shape.surface();
  const std::vector<double> expected = exact_areas(shape, sites.positions);
  const std::vector<Moments> found = restricted_voronoi(surface, sites, Cells::kEuclidean).cells;
  for (std::size_t i = 0; i < sites.size(); ++i)
    EXPECT_NEAR(found[i].area, expected[i], 1e-9 * surface.area())
        << "cell " << i << " on " << shape.name;
}

/// A Voronoi cell is the intersection of the half-spaces of its Delaunay neighbors whatever the
/// dimension of the triangulation, so sites in a plane are no special case.
TEST(Referee, AgreesOnRandomMeshes) {
  int solid = 0;
  for (std::uint64_t seed = 0; seed < kMeshes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(9000 + seed);
    const Shape shape = random_shape(random);
    const auto count = static_cast<std::size_t>(5 + random.below(12));
    const Sites sites = random_sites(shape, count, random);
    solid += triangulate(sites.positions).dimension() == 3 ? 1 : 0;
    expect_exact_areas(shape, sites);
    if (HasFailure()) return;
  }
  EXPECT_GE(solid, 100) << "too few of the meshes have sites that span space";
}

TEST(Referee, AgreesOnDegenerateSites) {
  for (std::uint64_t seed = 0; seed < kMeshes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(19000 + seed);
    const Shape shape = random_shape(random);
    const auto count = static_cast<std::size_t>(5 + random.below(12));
    expect_exact_areas(shape, degenerate_sites(shape, count, random));
    if (HasFailure()) return;
  }
}

class RefereeOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, RefereeOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(RefereeOf, Agrees) {
  Random random(31);
  expect_exact_areas(GetParam(), random_sites(GetParam(), 10, random));
}

/// Eight sites on one sphere: the Delaunay tetrahedralization of a cube is ambiguous, its cells are
/// not.
TEST(Referee, AgreesOnTheCornersOfACube) {
  const Shape shape = box(2);
  Sites sites;
  for (std::size_t v = 0; v < shape.vertices.size(); ++v) {
    const Vec3& p = shape.vertices[v];
    if (((p.array() - 0.5).abs() < 0.4).any()) continue;
    sites.positions.push_back(p);
    for (std::size_t f = 0; f < shape.faces.size(); ++f)
      for (const std::int32_t corner : shape.faces[f])
        if (static_cast<std::size_t>(corner) == v && sites.faces.size() < sites.positions.size())
          sites.faces.push_back(static_cast<std::int32_t>(f));
  }
  ASSERT_EQ(sites.size(), 8u);
  expect_exact_areas(shape, sites);
}

}  // namespace
}  // namespace dapple::test
