// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <dapple/projector.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <functional>

#include "brute_force.hpp"
#include "invariants.hpp"
#include "shared_data.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kRandomMeshes = 150;

double largest(const std::vector<BruteCell>& cells, double (*measure)(const BruteCell&)) {
  double result = 0.0;
  for (const BruteCell& cell : cells) result = std::max(result, measure(cell));
  return result;
}

double largest_flux(const BruteCell& cell) {
  double result = 0.0;
  for (const auto& [j, flux] : cell.flux) result = std::max(result, flux.norm());
  return result;
}

/// Check every integral of every cell to 1e-9 of the whole.
void expect_same_cells(const Shape& shape, const Surface& surface, const Sites& sites) {
  const std::vector<BruteCell> expected = brute_force_cells(shape, sites.positions);
  const RestrictedVoronoi found = restricted_voronoi(surface, sites, Cells::kEuclidean);
  const double size = std::sqrt(surface.area());
  const double mass = largest(expected, [](const BruteCell& cell) { return cell.moments.mass; });
  ASSERT_EQ(found.cells.size(), sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Moments &a = found.cells[i], &b = expected[i].moments;
    EXPECT_NEAR(a.area, b.area, 1e-9 * surface.area()) << "cell " << i;
    EXPECT_NEAR(a.capacity, b.capacity, 1e-9 * surface.capacity()) << "cell " << i;
    EXPECT_NEAR(a.mass, b.mass, 1e-9 * mass) << "cell " << i;
    EXPECT_LE((a.first - b.first).norm(), 1e-9 * mass * size) << "cell " << i;
    EXPECT_NEAR(a.second, b.second, 1e-9 * mass * size * size) << "cell " << i;
  }
}

/// Check the flux across each boundary to 1e-9 of the largest, and that no boundary is missing or
/// superfluous.
void expect_same_boundaries(const Shape& shape, const Surface& surface, const Sites& sites) {
  const std::vector<BruteCell> expected = brute_force_cells(shape, sites.positions);
  const RestrictedVoronoi found = restricted_voronoi(surface, sites, Cells::kEuclidean);
  const double flux = std::max(largest(expected, largest_flux), 1e-300);
  const double size = std::sqrt(surface.area());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    BruteCell left = expected[i];
    for (const CellBoundary& boundary : found.boundary(i)) {
      const Vec3 known =
          left.flux.count(boundary.neighbor) ? left.flux[boundary.neighbor] : Vec3::Zero();
      EXPECT_LE((boundary.flux - known).norm(), 1e-9 * flux)
          << i << " against " << boundary.neighbor;
      EXPECT_NEAR(boundary.length, left.length[boundary.neighbor], 1e-9 * size);
      left.flux.erase(boundary.neighbor);
    }
    for (const auto& [j, missed] : left.flux)
      EXPECT_LE(missed.norm(), 1e-9 * flux) << i << " against " << j;
  }
}

Sites at_points(std::initializer_list<Vec3> points, std::int32_t face = 0) {
  return {points, std::vector<std::int32_t>(points.size(), face)};
}

// ---- every unit of area belongs to exactly one site ----

class CellsOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, CellsOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(CellsOf, PartitionTheSurface) {
  const Surface surface = GetParam().surface();
  Random random(11);
  const std::size_t more_than_faces = 2 * GetParam().faces.size() + 100;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{10},
                                  std::size_t{100}, more_than_faces})
    check_cells(surface, random_sites(GetParam(), count, random));
}

TEST_P(CellsOf, PartitionTheSurfaceAmongDegenerateSites) {
  const Surface surface = GetParam().surface();
  Random random(12);
  for (const std::size_t count : {2u, 5u, 30u, 200u})
    check_cells(surface, degenerate_sites(GetParam(), count, random));
}

TEST_P(CellsOf, AgreeWithBruteForce) {
  const Surface surface = GetParam().surface();
  Random random(13);
  expect_same_cells(GetParam(), surface, random_sites(GetParam(), 25, random));
  expect_same_cells(GetParam(), surface, degenerate_sites(GetParam(), 25, random));
}

class CellsOfRealMesh : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Meshes, CellsOfRealMesh, testing::ValuesIn(shared_mesh_names()),
                         [](const auto& mesh) { return mesh.param; });

TEST_P(CellsOfRealMesh, PartitionTheSurface) {
  DAPPLE_NEEDS_MESH(GetParam());
  const Shape shape = shared_mesh(GetParam());
  const Surface surface = shape.surface();
  Random random(14);
  for (const std::size_t count : {1u, 10u, 1000u})
    check_cells(surface, random_sites(shape, count, random));
}

TEST_P(CellsOfRealMesh, PartitionTheSurfaceAmongMoreSitesThanFaces) {
  DAPPLE_NEEDS_MESH(GetParam());
  const Shape shape = shared_mesh(GetParam());
  Random random(15);
  check_cells(shape.surface(), random_sites(shape, shape.faces.size() + 1000, random));
}

// ---- the brute-force oracle ----

TEST(RestrictedVoronoi, AgreesWithBruteForceOnRandomMeshes) {
  for (std::uint64_t seed = 0; seed < kRandomMeshes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(1000 + seed);
    const Shape shape = random_shape(random);
    const Surface surface = shape.surface();
    const auto count = static_cast<std::size_t>(1 + random.below(30));
    const Sites sites = random_sites(shape, count, random);
    expect_same_cells(shape, surface, sites);
    expect_same_boundaries(shape, surface, sites);
    if (HasFailure()) return;
  }
}

TEST(RestrictedVoronoi, AgreesWithBruteForceOnDegenerateSites) {
  for (std::uint64_t seed = 0; seed < kRandomMeshes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(5000 + seed);
    const Shape shape = random_shape(random);
    const auto count = static_cast<std::size_t>(1 + random.below(30));
    expect_same_cells(shape, shape.surface(), degenerate_sites(shape, count, random));
    if (HasFailure()) return;
  }
}

TEST(RestrictedVoronoi, AgreesWithBruteForceOnACocircularLattice) {
  Shape shape = grid(7);
  Sites sites;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      sites.positions.emplace_back(0.125 + 0.25 * x, 0.125 + 0.25 * y, 0.0);
  for (const Vec3& p : sites.positions) {
    const auto cell = 2 * (static_cast<int>(7 * p.y()) * 7 + static_cast<int>(7 * p.x()));
    const double u = 7 * p.x() - std::floor(7 * p.x()), v = 7 * p.y() - std::floor(7 * p.y());
    sites.faces.push_back(cell + (v > u ? 1 : 0));
  }
  expect_same_cells(shape, shape.surface(), sites);
  for (const Moments& cell : restricted_voronoi(shape.surface(), sites, Cells::kEuclidean).cells)
    EXPECT_NEAR(cell.area, 1.0 / 16, 1e-13);
}

TEST(RestrictedVoronoi, AgreesWithBruteForceWithASiteOnEveryVertex) {
  const Shape shape = blob(1);
  Sites sites{shape.vertices, std::vector<std::int32_t>(shape.vertices.size())};
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    for (const std::int32_t v : shape.faces[f])
      sites.faces[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(f);
  expect_same_cells(shape, shape.surface(), sites);
}

// ---- ties ----

TEST(RestrictedVoronoi, TheFirstOfCoincidentSitesGetsTheCell) {
  const Surface surface = triangle().surface();
  const Vec3 p = surface.point(0, {0.3, 0.3, 0.4});
  const RestrictedVoronoi found =
      restricted_voronoi(surface, at_points({p, p, p}), Cells::kEuclidean);
  EXPECT_NEAR(found.cells[0].area, surface.area(), 1e-15);
  for (const std::size_t twin : {1u, 2u}) {
    EXPECT_EQ(found.cells[twin].area, 0.0);
    EXPECT_TRUE(found.boundary(twin).empty());
  }
}

/// The flood meets coincident sites on different faces around a vertex in another order: neighbors
/// must border on the first of them, not on one with an empty cell. The search must not take
/// quadratic time.
TEST(RestrictedVoronoi, ManyCoincidentSitesTakeLinearTime) {
  const Shape shape = icosphere(2);
  const std::size_t count = 300'000;
  const Sites sites{std::vector<Vec3>(count, shape.point(5, Vec3(0.2, 0.3, 0.5))),
                    std::vector<std::int32_t>(count, 5)};
  for (const Cells cells : {Cells::kConnected, Cells::kEuclidean}) {
    const RestrictedVoronoi diagram = restricted_voronoi(shape.surface(), sites, cells);
    EXPECT_NEAR(diagram.cells[0].capacity, shape.area(), 1e-12 * shape.area());
    for (std::size_t k = 1; k < count; ++k) ASSERT_EQ(diagram.cells[k].area, 0.0);
  }
}

/// Coincident sites on the two faces of an edge, among many sites on one of them.
TEST(RestrictedVoronoi, TheFirstOfManyCoincidentSitesGetsTheCell) {
  const Shape shape = grid(1);
  const Vec3 middle = 0.5 * (shape.vertices[static_cast<std::size_t>(shape.faces[0][0])] +
                             shape.vertices[static_cast<std::size_t>(shape.faces[0][2])]);
  Sites sites{std::vector<Vec3>(40, middle), std::vector<std::int32_t>(40, 0)};
  sites.faces[0] = 1;
  const RestrictedVoronoi diagram = restricted_voronoi(shape.surface(), sites, Cells::kEuclidean);
  EXPECT_NEAR(diagram.cells[0].capacity, 1.0, 1e-12);
}

/// Sites on a part of the unit square with 200 near neighbors each, whose cells are long.
Sites crowded_sites(const Surface& surface, const std::function<Vec3(int)>& place) {
  std::vector<Vec3> places;
  for (int k = 0; k < 200; ++k) places.push_back(place(k));
  const Projection found = Projector(surface).project(places);
  return {found.positions, found.faces, found.barycentric};
}

TEST(RestrictedVoronoi, AgreesWithBruteForceWhereASmallPartHasAllSites) {
  Random random(7);
  const Shape square = grid(12), ball = icosphere(2);
  const auto in_corner = [&](int) {
    return Vec3(0.2 * random.uniform(), 0.3 * random.uniform(), 0);
  };
  const auto lattice = [](int k) { return Vec3(0.01 * (k % 20), 0.01 * (k / 20), 0.0); };
  const auto twins = [&](int k) { return lattice(k / 3); };
  const auto on_cap = [&](int) -> Vec3 { return Vec3(0.3, 0.2, 1) + 0.2 * random.in_box(); };
  expect_same_cells(square, square.surface(), crowded_sites(square.surface(), in_corner));
  expect_same_cells(square, square.surface(), crowded_sites(square.surface(), lattice));
  expect_same_cells(square, square.surface(), crowded_sites(square.surface(), twins));
  expect_same_cells(ball, ball.surface(), crowded_sites(ball.surface(), on_cap));
}

/// Triangles that have only the origin in common, 30 degrees apart.
Shape propeller() {
  Shape shape{"Propeller", {Vec3::Zero()}, {}};
  for (std::int32_t k = 0; k < 6; ++k) {
    for (const double angle : {1.0471975511965976 * k, 1.0471975511965976 * k + 0.5})
      shape.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    shape.faces.push_back({0, 2 * k + 1, 2 * k + 2});
  }
  return shape;
}

TEST(RestrictedVoronoi, GivesAPartWithoutSitesToCoincidentSitesOnce) {
  const Shape shape = propeller();
  const Surface surface(shape.vertices, shape.faces);
  const Vec3 inside = surface.point(2, {0.2, 0.4, 0.4});
  for (const Cells cells : {Cells::kConnected, Cells::kEuclidean})
    for (const std::vector<std::int32_t>& faces :
         {std::vector<std::int32_t>{0, 1, 2}, {1, 0, 2}, {0, 0, 2, 1}, {0, 4, 2, 5, 1}}) {
      Sites sites;
      for (const std::int32_t face : faces) {
        sites.faces.push_back(face);
        sites.positions.push_back(face == 2 ? inside : Vec3::Zero());
      }
      double area = 0.0;
      for (const Moments& cell : restricted_voronoi(surface, sites, cells).cells) area += cell.area;
      EXPECT_NEAR(area, surface.area(), 1e-12) << faces.size() << " sites";
    }
}

TEST(RestrictedVoronoi, NamesTheFirstOfCoincidentSitesAsNeighbor) {
  const Shape shape = grid(4);
  const Surface surface = shape.surface();
  const Projection others =
      Projector(surface).project(std::vector<Vec3>{{0.1, 0.2, 0}, {0.9, 0.3, 0}, {0.4, 0.9, 0}});
  const Vec3 corner(0.5, 0.5, 0.0);
  std::vector<std::int32_t> around;
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    for (const std::int32_t v : shape.faces[f])
      if (shape.vertices[static_cast<std::size_t>(v)] == corner)
        around.push_back(static_cast<std::int32_t>(f));
  ASSERT_GE(around.size(), 4u);
  for (const std::int32_t a : around)
    for (const std::int32_t b : around) {
      Sites sites{{corner, corner}, {a, b}};
      sites.positions.insert(sites.positions.end(), others.positions.begin(),
                             others.positions.end());
      sites.faces.insert(sites.faces.end(), others.faces.begin(), others.faces.end());
      const RestrictedVoronoi diagram = restricted_voronoi(surface, sites, Cells::kEuclidean);
      EXPECT_EQ(diagram.cells[1].area, 0.0);
      for (const CellBoundary& side : diagram.boundaries) EXPECT_NE(side.neighbor, 1);
    }
}

TEST(RestrictedVoronoi, KeepsManyCoincidentSitesApartFromTheRest) {
  const Shape shape = grid(3);
  const Surface surface = shape.surface();
  Sites sites = at_points({});
  Random random(4);
  const Sites others = random_sites(shape, 5, random);
  for (int k = 0; k < 100; ++k) {
    sites.positions.push_back(surface.point(8, {0.25, 0.25, 0.5}));
    sites.faces.push_back(8);
  }
  sites.positions.insert(sites.positions.end(), others.positions.begin(), others.positions.end());
  sites.faces.insert(sites.faces.end(), others.faces.begin(), others.faces.end());
  expect_same_cells(shape, surface, sites);
}

/// Faces that lie in the bisector of two sites are equally near to both: each of them belongs to
/// one site.
TEST(RestrictedVoronoi, GivesASheetInABisectorToOneSite) {
  const auto lifted = [](double z) {
    return mapped(grid(2), [z](const Vec3& p) { return Vec3(p.x(), p.y(), z); });
  };
  const Shape shape = joined(joined(lifted(-0.25), lifted(0.0)), lifted(0.25));
  const Sites sites{{Vec3(0.3, 0.2, 0.25), Vec3(0.3, 0.2, -0.25)}, {16, 0}};
  check_cells(shape.surface(), sites);
}

/// The flood reaches the faces in the bisector over mesh edges from both sides. The order of sites
/// and the coordinate frame vary, so that ties hold only up to rounding.
TEST(RestrictedVoronoi, GivesAWallInABisectorToTheFirstSite) {
  const Sites sites{{Vec3(-0.3, 0.525, 0.0), Vec3(0.3, 0.525, 0.0), Vec3(-0.3, 0.125, 0.0),
                     Vec3(0.3, 0.125, 0.0)},
                    {16, 22, 0, 6}};
  for (int frame = 0; frame < 50; ++frame) {
    const auto map = [frame](const Vec3& p) {
      return frame == 0 ? p : Vec3(rotated(1.7 * p + Vec3(3, 1, -2), 0.1 * frame));
    };
    const Surface surface = mapped(tee(2), map).surface();
    for (const bool swapped : {false, true}) {
      Sites moved;
      for (std::size_t k = 0; k < sites.size(); ++k) {
        const std::size_t from = swapped ? sites.size() - 1 - k : k;
        moved.positions.push_back(map(sites.positions[from]));
        moved.faces.push_back(sites.faces[from]);
      }
      check_cells(surface, moved);
    }
    if (HasFailure()) return;
  }
}

// ---- pieces that the flood from the site does not reach ----

TEST(RestrictedVoronoi, DividesANeedleAmongNearlyCoincidentSites) {
  const double width = 1e-6, apart = 1e-9;
  const Shape needle{"Needle", {{-1, -width, 0}, {1, -width, 0}, {0, width, 0}}, {{0, 1, 2}}};
  const Surface surface = needle.surface();
  const Sites sites =
      at_points({{0, 0, 0}, {0.9 * apart, 0, 0}, {-0.9 * apart, 0, 0}, {0, apart, 0}});
  check_cells(surface, sites);
  for (const Moments& cell : restricted_voronoi(surface, sites, Cells::kEuclidean).cells)
    EXPECT_GT(cell.area, 0.0);
}

/// Up to rounding, one plane separates the first site from all others, which share the far face.
TEST(RestrictedVoronoi, DividesAFarFaceAmongNearlyCoincidentSites) {
  const Shape strips{"Strips",
                     {{0.49991061251485119, 0.0078799890410303618, -0.0052235301989706391},
                      {0.24315485459186401, 0.43689314884895042, -0.00030524950177540297},
                      {0.24315485461526307, 0.43689314883748009, -0.00030524727970597998},
                      {-0.24315485456846511, -0.43689314886042063, 0.00030525172384482813},
                      {0.25675575796978545, -0.42901315983086069, -0.004918276253056391},
                      {-0.24315485454506608, -0.43689314887189096, 0.00030525394591425113}},
                     {{0, 1, 2}, {3, 4, 5}}};
  const Surface surface = strips.surface();
  const Sites sites =
      at_points({{0.34791010699227543, 0.26185761253709777, -0.0023118714844381988},
                 {0.49991061268791248, 0.0078799889561949332, -0.0052235137643709059},
                 {0.49991061258504832, 0.0078799890066193843, -0.0052235235327623697},
                 {0.49991061251485119, 0.0078799890410303618, -0.0052235301989706391}});
  check_cells(surface, sites, 1e-8 * surface.area());
}

// Rounding errors there exceed the density and have either sign.
TEST(RestrictedVoronoi, HasNoNegativeCapacityWhereTheDensityFallsTo0) {
  const Shape shape = {
      "Ramp", {{0, 0, 0}, {1.3, 0.1, 0.4}, {0.2, 1.1, 0.7}}, {{0, 1, 2}}, {0.0, 0.7, 1.3}};
  Random random(1);
  Sites sites;
  for (int k = 0; k < 200; ++k) {
    const double u = 1e-16 * random.uniform(), v = 1e-16 * random.uniform();
    sites.positions.emplace_back(u * shape.vertices[1] + v * shape.vertices[2]);
    sites.faces.push_back(0);
  }
  check_cells(shape.surface(), sites);
}

TEST(RestrictedVoronoi, GivesAFaceTooFarForSquaresOfDistancesToASite) {
  const Shape far{"Far", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e155, 0, 0}}, {{0, 1, 2}, {0, 1, 3}}};
  check_cells(far.surface(), at_points({{0.1, 0.1, 0}, {0.5, 0.2, 0}, {0.2, 0.5, 0}}));
}

/// Of two sites, one has no part of a far face, although its neighbor's polygons are labeled with
/// it.
TEST(RestrictedVoronoi, DividesAFarFaceOfWhichOneOfTwoSitesHasNoPart) {
  const Shape soup{"Soup",
                   {{-0.78176004240493324, -0.1235957196152762, 0.66243698837750675},
                    {-1.3074226343229862, 0.16375664381929414, 0.84902025454049612},
                    {-0.89784828806038852, 0.1466031307053545, 0.97858495937018553},
                    {0.71936261793862111, -0.06182504279540986, -0.70096114964139589},
                    {0.6569290004166366, -0.050995223220129615, -0.10573968413193523},
                    {0.84803986685143828, -0.68231355456679144, 0.16351224639481757},
                    {-0.74727815157166955, -0.40464495496543373, -0.13770731531103153},
                    {-0.010400009674089468, -0.1099121516457448, -0.067767541821985577},
                    {-0.28934808436662546, -0.21764465946869024, -0.55983243403230709},
                    {-0.29957627073306314, 0.16396422025939267, -0.86446797453422819},
                    {-0.23603109246143014, 1.1069256170300776, -0.55959595097378856},
                    {-0.77743526303134947, 0.45427021012477231, 0.18836594942647145}},
                   {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}}};
  const Surface surface = soup.surface();
  Sites sites = at_points({{-0.74727815157166955, -0.40464495496543373, -0.13770731531103153},
                           {0.7196217026980043, -0.12557964321776033, -0.48069747269726992},
                           {0.7196217026980043, -0.1255796432177603, -0.48069747269726987},
                           {-0.91840041854575671, 0.098846107971065217, 0.90742677152551665}});
  sites.faces = {2, 1, 1, 0};
  check_cells(surface, sites, 1e-8 * surface.area());
}

TEST(RestrictedVoronoi, ReachesThroughWalls) {
  const Shape shape = two_sheets(4, 0.01);
  Random random(21);
  Sites sites = random_sites(shape, 30, random);
  for (std::size_t k = 0; k < 30; ++k) {  // all on the lower sheet
    sites.faces[k] %= 32;
    sites.positions[k] = shape.point(sites.faces[k], random.weights());
  }
  expect_same_cells(shape, shape.surface(), sites);
  expect_same_boundaries(shape, shape.surface(), sites);
}

TEST(RestrictedVoronoi, HandlesMoreComponentsThanSites) {
  const Shape shape = many_components(60);
  Random random(22);
  for (const std::size_t count : {1u, 2u, 7u})
    expect_same_cells(shape, shape.surface(), random_sites(shape, count, random));
}

// ---- units ----

TEST(RestrictedVoronoi, DoesNotDependOnUnitsOrOrigin) {
  const Shape shape = blob(2);
  Random random(23);
  const Sites sites = random_sites(shape, 80, random, true);
  const RestrictedVoronoi base = restricted_voronoi(shape.surface(), sites, Cells::kEuclidean);
  struct Case {
    double scale, shift, tolerance;
  };
  for (const Case& c :
       {Case{1e-6, 0, 1e-13}, Case{1e6, 0, 1e-13}, Case{1, 1e6, 1e-8}, Case{1e-6, 1.0, 1e-8}}) {
    const auto map = [&](const Vec3& p) {
      return Vec3(c.scale * p + Vec3(c.shift, -c.shift, c.shift));
    };
    Sites moved = sites;
    for (Vec3& p : moved.positions) p = map(p);
    const Surface surface = mapped(shape, map).surface();
    check_cells(surface, moved);
    const RestrictedVoronoi found = restricted_voronoi(surface, moved, Cells::kEuclidean);
    for (std::size_t i = 0; i < sites.size(); ++i)
      EXPECT_NEAR(found.cells[i].area / (c.scale * c.scale), base.cells[i].area, c.tolerance)
          << c.scale << " " << c.shift;
  }
}

// ---- the pieces themselves ----

double polygon_area(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < points.size(); ++k)
    sum += (points[k] - points[0]).cross(points[k + 1] - points[0]);
  return 0.5 * sum.norm();
}

/// Capacity and flux are integrals of the density, mass and its moments those of its square.
TEST(RestrictedVoronoi, ScalesWithTheDensity) {
  const Shape shape = with_density(blob(2), [](const Vec3& p) { return 2.0 + p.x(); });
  Random random(16);
  const Sites sites = random_sites(shape, 20, random);
  const RestrictedVoronoi once = restricted_voronoi(shape.surface(), sites, Cells::kEuclidean);
  for (const double factor : {1e-30, 1e-3, 7.0, 1e30}) {
    const auto scaled = [factor](const Vec3& p) { return factor * (2.0 + p.x()); };
    const RestrictedVoronoi found =
        restricted_voronoi(with_density(shape, scaled).surface(), sites, Cells::kEuclidean);
    const double square = factor * factor;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const Moments &a = found.cells[i], &b = once.cells[i];
      EXPECT_DOUBLE_EQ(a.area, b.area) << factor;
      EXPECT_NEAR(a.capacity / factor, b.capacity, 1e-12 * b.capacity) << factor;
      EXPECT_NEAR(a.mass / square, b.mass, 1e-12 * b.mass) << factor;
      EXPECT_LE((a.first / square - b.first).norm(), 1e-12 * b.mass) << factor;
      EXPECT_NEAR(a.second / square, b.second, 1e-12 * b.mass) << factor;
      ASSERT_EQ(found.boundary(i).size(), once.boundary(i).size());
      for (std::size_t k = 0; k < once.boundary(i).size(); ++k) {
        const Vec3 flux = found.boundary(i)[k].flux / factor;
        EXPECT_LE((flux - once.boundary(i)[k].flux).norm(), 1e-12) << factor;
      }
    }
  }
}

TEST_P(CellsOf, AreCutIntoPolygonsOfTheSameArea) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  Random random(24);
  const Sites sites = random_sites(shape, 40, random);
  std::vector<double> area(sites.size(), 0.0), covered(shape.faces.size(), 0.0);
  std::int32_t last = 0;
  for (const CellPolygon& piece : restricted_voronoi_polygons(surface, sites, Cells::kEuclidean)) {
    ASSERT_GE(piece.site, last) << "not sorted by site";
    last = piece.site;
    ASSERT_EQ(piece.points.size(), piece.edges.size());
    area[static_cast<std::size_t>(piece.site)] += polygon_area(piece.points);
    covered[static_cast<std::size_t>(piece.face)] += polygon_area(piece.points);
  }
  const std::vector<Moments> cells = restricted_voronoi(surface, sites, Cells::kEuclidean).cells;
  for (std::size_t i = 0; i < area.size(); ++i)
    EXPECT_NEAR(area[i], cells[i].area, 1e-10 * surface.area());
  const std::vector<bool> counts = shape.counted();
  for (std::size_t f = 0; f < covered.size(); ++f)
    EXPECT_NEAR(covered[f], counts[f] ? shape.face_area(static_cast<std::int32_t>(f)) : 0.0,
                1e-10 * surface.area())
        << "face " << f;
}

TEST(RestrictedVoronoi, MarksTheEdgesOfItsPolygons) {
  const Shape shape = blob(1);
  Random random(25);
  const Sites sites = random_sites(shape, 40, random);
  for (const CellPolygon& piece :
       restricted_voronoi_polygons(shape.surface(), sites, Cells::kEuclidean)) {
    const Vec3& site = sites.positions[static_cast<std::size_t>(piece.site)];
    const Face& face = shape.faces[static_cast<std::size_t>(piece.face)];
    for (std::size_t k = 0; k < piece.points.size(); ++k) {
      const Vec3 middle = 0.5 * (piece.points[k] + piece.points[(k + 1) % piece.points.size()]);
      if (piece.edges[k] >= 0) {
        const Vec3& other = sites.positions[static_cast<std::size_t>(piece.edges[k])];
        EXPECT_NEAR((middle - site).norm(), (middle - other).norm(), 1e-12);
        continue;
      }
      const auto corner = static_cast<std::size_t>(-1 - piece.edges[k]);
      const Vec3& a = shape.vertices[static_cast<std::size_t>(face[corner])];
      const Vec3& b = shape.vertices[static_cast<std::size_t>(face[(corner + 1) % 3])];
      EXPECT_LE((middle - a).cross(b - a).norm(), 1e-12);
    }
  }
}

TEST(RestrictedVoronoi, HasSymmetricBoundaryLengths) {
  const Shape shape = blob(2);
  Random random(26);
  const RestrictedVoronoi found =
      restricted_voronoi(shape.surface(), random_sites(shape, 100, random), Cells::kEuclidean);
  for (std::size_t i = 0; i < 100; ++i)
    for (const CellBoundary& one : found.boundary(i)) {
      double back = 0.0;
      for (const CellBoundary& other : found.boundary(static_cast<std::size_t>(one.neighbor)))
        if (other.neighbor == static_cast<std::int32_t>(i)) back += other.length;
      EXPECT_NEAR(one.length, back, 1e-11) << i << " and " << one.neighbor;
    }
}

TEST(RestrictedVoronoi, OfNoSitesIsEmpty) {
  const RestrictedVoronoi found = restricted_voronoi(grid(2).surface(), {}, Cells::kEuclidean);
  EXPECT_TRUE(found.cells.empty());
  EXPECT_TRUE(found.boundaries.empty());
  EXPECT_TRUE(restricted_voronoi_polygons(grid(2).surface(), {}, Cells::kEuclidean).empty());
}

}  // namespace
}  // namespace dapple::test
