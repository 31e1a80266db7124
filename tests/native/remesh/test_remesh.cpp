// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/projector.hpp>
#include <dapple/remesh.hpp>
#include <dapple/topology.hpp>
#include <map>
#include <numbers>
#include <set>

#include "mesh_area.hpp"
#include "shapes.hpp"
#include "shared_data.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Edge = std::array<std::int32_t, 2>;

Topology topology_of(const RemeshResult& mesh) {
  SurfaceOptions plain;
  plain.weld = std::nullopt;
  return topology(Surface(mesh.vertices, mesh.faces, Density{}, plain));
}

/// Vertices - edges + faces of a manifold surface without loose vertices.
std::int32_t euler_of(const Topology& topology) {
  return 2 * topology.components - 2 * topology.genus - topology.border_loops;
}

/// What holds for each mesh, whatever the surface is.
void expect_consistent(const Surface& surface, const RemeshResult& mesh) {
  const std::size_t count = mesh.vertices.size();
  ASSERT_EQ(mesh.source_faces.size(), count);
  ASSERT_EQ(mesh.barycentric.size(), count);
  ASSERT_EQ(mesh.features.size(), count);
  EXPECT_EQ(mesh.report.vertices, count);
  EXPECT_EQ(mesh.report.faces, mesh.faces.size());
  const double size = surface.spacing(1);
  for (std::size_t k = 0; k < count; ++k) {
    ASSERT_GE(mesh.source_faces[k], 0);
    ASSERT_LT(mesh.source_faces[k], static_cast<std::int32_t>(surface.face_count()));
    EXPECT_GE(mesh.barycentric[k].minCoeff(), 0.0);
    EXPECT_NEAR(mesh.barycentric[k].sum(), 1.0, 1e-9);
    const Vec3 there = surface.point(mesh.source_faces[k], mesh.barycentric[k]);
    EXPECT_LE((there - mesh.vertices[k]).norm(), 1e-9 * size);
  }
  std::set<std::int32_t> used;
  for (const Face& face : mesh.faces) {
    EXPECT_EQ((std::set<std::int32_t>(face.begin(), face.end()).size()), 3u);
    for (const std::int32_t v : face) {
      ASSERT_GE(v, 0);
      ASSERT_LT(v, static_cast<std::int32_t>(count));
      used.insert(v);
    }
  }
  EXPECT_EQ(used.size(), count);
}

class RemeshShapes : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(All, RemeshShapes, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(RemeshShapes, HasTheTopologyOfTheSurface) {
  const Surface surface = GetParam().surface();
  const RemeshResult mesh = remesh(surface, 150);
  expect_consistent(surface, mesh);
  if (GetParam().name.starts_with("ZeroAreaFaces")) return;  // faces meet across ones without area
  EXPECT_EQ(mesh.report.flaws, 0u);
  const Topology before = topology(surface);
  if (!before.manifold) return;
  const Topology after = topology_of(mesh);
  EXPECT_TRUE(after.manifold);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.border_loops, before.border_loops);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(mesh.report.euler, euler_of(before));
}

TEST_P(RemeshShapes, IsManifoldIfCutApart) {
  const Surface surface = GetParam().surface();
  RemeshOptions options;
  options.non_manifold = NonManifold::kCut;
  const RemeshResult mesh = remesh(surface, 150, options);
  expect_consistent(surface, mesh);
  EXPECT_EQ(mesh.report.nonmanifold_edges, 0u);
}

TEST(Remesh, HasExactlyAsManyVerticesAsAsked) {
  for (const std::size_t count : {100u, 333u, 1000u})
    EXPECT_EQ(remesh(blob(4).surface(), count).vertices.size(), count);
}

TEST(Remesh, CountsTrianglesThatPassThroughOthers) {
  const auto beside = [](double x) {
    return mapped(icosphere(3), [&](const Vec3& p) { return Vec3(p + Vec3(x, 0.0, 0.0)); });
  };
  EXPECT_EQ(remesh(joined(icosphere(3), beside(2.5)).surface(), 400).report.self_intersecting, 0u);
  const RemeshResult mesh = remesh(joined(icosphere(3), beside(1.5)).surface(), 400);
  EXPECT_GT(mesh.report.self_intersecting, 20u);
  EXPECT_LT(mesh.report.self_intersecting, 200u);
}

TEST(Remesh, CountsNoneWhereSheetsTouchAlone) {
  RemeshOptions options;
  options.non_manifold = NonManifold::kCut;
  EXPECT_EQ(remesh(fin(6).surface(), 150, options).report.self_intersecting, 0u);
  EXPECT_EQ(remesh(bow_tie().surface(), 40, options).report.self_intersecting, 0u);
}

TEST(Remesh, MakesGoodTriangles) {
  const RemeshResult mesh = remesh(icosphere(4).surface(), 1000);
  EXPECT_GT(mesh.report.smallest_angle, 35.0);
  EXPECT_GT(mesh.report.mean_smallest_angle, 53.0);
  EXPECT_GT(mesh.report.valence_6, 0.8);
  EXPECT_EQ(mesh.report.flipped, 0u);
}

TEST(Remesh, KeepsCornersAndCreasesOfACube) {
  const Surface surface = box(4).surface();
  const RemeshResult mesh = remesh(surface, 500);
  EXPECT_EQ(mesh.vertices.size(), 500u);
  EXPECT_EQ(mesh.report.corners, 8u);
  EXPECT_NEAR(area_of(mesh.vertices, mesh.faces), 6.0, 1e-9);  // so no triangle crosses a crease
  std::set<std::array<double, 3>> corners;
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k)
    if (mesh.features[k] == VertexFeature::kCorner)
      corners.insert({mesh.vertices[k][0], mesh.vertices[k][1], mesh.vertices[k][2]});
  EXPECT_EQ(corners.size(), 8u);
}

TEST(Remesh, MakesTwelveTrianglesOfTheCornersOfACube) {
  const RemeshResult mesh = remesh(box(1).surface(), 8);
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.faces.size(), 12u);
  EXPECT_NEAR(area_of(mesh.vertices, mesh.faces), 6.0, 1e-12);
}

/// A body with a displacement of each vertex by as much of its edges, as a scan has.
Shape rough(Shape shape, double part) {
  Random random(1);
  const double edge = (shape.vertices[static_cast<std::size_t>(shape.faces[0][0])] -
                       shape.vertices[static_cast<std::size_t>(shape.faces[0][1])])
                          .norm();
  return mapped(std::move(shape), [&](const Vec3& p) {
    return Vec3(p + part * edge * random.between(-1.0, 1.0) * p.normalized());
  });
}

TEST(Remesh, KeepsNoCreasesOfNoise) {
  const Surface surface = rough(icosphere(4), 0.3).surface();
  for (const std::size_t count : {2500u, 10000u}) {
    const RemeshResult mesh = remesh(surface, count);
    EXPECT_EQ(mesh.report.on_lines, 0u);
    EXPECT_GT(mesh.report.smallest_angle, 30.0);
  }
}

TEST(Remesh, KeepsTheCubeBesideARoughBody) {
  const Shape cube = mapped(box(4), [](const Vec3& p) { return Vec3(p + Vec3(3, 0, 0)); });
  const RemeshResult mesh = remesh(joined(rough(icosphere(4), 0.3), cube).surface(), 4000);
  EXPECT_EQ(mesh.report.corners, 8u);
  EXPECT_EQ(mesh.report.flaws, 0u);
}

TEST(Remesh, KeepsTheCreasesOfARoughCube) {
  Random random(2);
  const Shape cube = mapped(box(20), [&](const Vec3& p) {
    int axis = 0, sides = 0;
    for (int k = 0; k < 3; ++k)
      if (p[k] == 0.0 || p[k] == 1.0) {
        axis = k;
        ++sides;
      }
    return sides > 1 ? p : Vec3(p + 0.01 * random.between(-1.0, 1.0) * Vec3::Unit(axis));
  });
  const RemeshResult mesh = remesh(cube.surface(), 1500);
  EXPECT_EQ(mesh.report.corners, 8u);
  EXPECT_EQ(mesh.report.flaws, 0u);
}

TEST(Remesh, CutsCornersIfNoCreaseIsKept) {
  RemeshOptions options;
  options.feature_angle = 180.0;
  const RemeshResult mesh = remesh(box(4).surface(), 500, options);
  EXPECT_EQ(mesh.report.on_lines, 0u);
  EXPECT_LT(area_of(mesh.vertices, mesh.faces), 6.0 - 1e-3);
}

TEST(Remesh, KeepsBordersWhereTheyAre) {
  const RemeshResult mesh = remesh(grid(6).surface(), 200);
  EXPECT_EQ(mesh.report.corners, 4u);
  EXPECT_EQ(mesh.report.border_loops, 1);
  EXPECT_NEAR(area_of(mesh.vertices, mesh.faces), 1.0, 1e-12);
}

TEST(Remesh, IsNearlyALatticeBesideBorders) {
  const RemeshResult mesh = remesh(grid(40).surface(), 2000);
  EXPECT_GT(mesh.report.valence_6, 0.9);
  EXPECT_LT(mesh.report.evaluations, 40);
}

TEST(Remesh, KeepsMarkedEdges) {
  const Shape shape = grid(4);  // 5 x 5 vertices, row after row
  RemeshOptions options;
  for (std::int32_t k = 0; k < 4; ++k) options.edges.push_back({5 * k + 2, 5 * k + 7});
  const Surface surface = shape.surface();
  const Vec3 first = shape.vertices[2], last = shape.vertices[22];
  const RemeshResult mesh = remesh(surface, 200, options);
  const Vec3 along = (last - first).normalized();
  const auto side = [&](std::int32_t v) {
    const Vec3 at = mesh.vertices[static_cast<std::size_t>(v)] - first;
    const double s = along.cross(at)[2];
    return std::abs(s) < 1e-12 ? 0 : s > 0.0 ? 1 : -1;
  };
  for (const Face& face : mesh.faces) {
    const auto [low, high] = std::minmax({side(face[0]), side(face[1]), side(face[2])});
    EXPECT_FALSE(low < 0 && high > 0) << "a triangle crosses the marked edges";
  }
}

TEST(Remesh, NamesAMarkedEdgeThatIsNone) {
  RemeshOptions options;
  options.edges = {{0, 1}, {0, 24}};
  expect_message<ArgumentError>([&] { std::ignore = remesh(grid(4).surface(), 100, options); },
                                {"edges[1] is (0, 24): no face has this edge"});
}

TEST(Remesh, RefusesNoVertices) {
  expect_message<ArgumentError>([&] { std::ignore = remesh(grid(4).surface(), 0); },
                                {"count is 0: it must be >= 1"});
}

TEST(Remesh, LinesAreEdgesOfTheMesh) {
  const RemeshResult mesh = remesh(box(4).surface(), 300);
  std::set<Edge> edges;
  for (const Face& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.insert({a, b});
    }
  double length = 0.0;
  for (const Edge& line : mesh.lines) {
    EXPECT_TRUE(edges.contains(line));
    length += (mesh.vertices[static_cast<std::size_t>(line[0])] -
               mesh.vertices[static_cast<std::size_t>(line[1])])
                  .norm();
  }
  EXPECT_NEAR(length, 12.0, 1e-12);
}

TEST(Remesh, FollowsTheDensity) {
  const Shape shape = with_density(grid(8), [](const Vec3& p) { return p[0] < 0.5 ? 1.0 : 4.0; });
  const RemeshResult mesh = remesh(shape.surface(), 600);
  const auto right = std::ranges::count_if(mesh.vertices, [](const Vec3& p) { return p[0] > 0.5; });
  EXPECT_GT(right, 400);
}

TEST(Remesh, IsTheSameForAnyNumberOfThreads) {
  const Surface surface = blob(3).surface();
  RemeshOptions one, many;
  one.threads = 1;
  many.threads = 5;
  const RemeshResult a = remesh(surface, 400, one), b = remesh(surface, 400, many);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.faces, b.faces);
}

/// A long blade of a few large faces, with an edge of 10 degrees.
Shape blade() {
  const double half = 0.5, thick = 0.0875 * half;
  return {"Blade",
          {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, half, thick), Vec3(4, half, thick),
           Vec3(0, half, -thick), Vec3(4, half, -thick)},
          {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}}};
}

/// Largest distance of the vertices and middles of triangles of one mesh from another.
double distance_of(std::span<const Vec3> vertices, std::span<const Face> faces,
                   const Surface& other) {
  std::vector<Vec3> points(vertices.begin(), vertices.end());
  for (const auto& [a, b, c] : faces)
    points.push_back((vertices[static_cast<std::size_t>(a)] +
                      vertices[static_cast<std::size_t>(b)] +
                      vertices[static_cast<std::size_t>(c)]) /
                     3.0);
  return std::ranges::max(Projector(other).project(points).distances);
}

TEST(Remesh, AddsVerticesWhereTheMeshIsTooFarFromTheSurface) {
  const Shape bumpy = blob(4);
  const Surface surface = bumpy.surface();
  const auto apart = [&](const RemeshResult& mesh) {
    return std::max(distance_of(mesh.vertices, mesh.faces, surface),
                    distance_of(bumpy.vertices, bumpy.faces, Surface(mesh.vertices, mesh.faces)));
  };
  const RemeshResult coarse = remesh(surface, 60);
  const double limit = 0.4 * apart(coarse);
  const RemeshResult mesh = remesh(surface, 60, {.max_distance = limit});
  expect_consistent(surface, mesh);
  EXPECT_EQ(coarse.report.distance, 0.0);  // it was not asked for
  EXPECT_LE(apart(mesh), limit);
  EXPECT_LE(mesh.report.distance, limit);
  EXPECT_GT(mesh.vertices.size(), 60u);
  EXPECT_LT(mesh.vertices.size(), 300u);
  EXPECT_EQ(mesh.report.flaws, 0u);
  EXPECT_EQ(mesh.report.euler, 2);
}

TEST(Remesh, KeepsTheEndWithoutLinesOfABodyWhoseLinesUseUpTheVertices) {
  const Shape ball = icosphere(3);
  RemeshOptions options;
  for (const Face& face : ball.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(face[k], face[(k + 1) % 3]);
      const auto high = [&](std::int32_t v) {
        return ball.vertices[static_cast<std::size_t>(v)][2] > 0.2;
      };
      if (a == face[k] && high(a) && high(b)) options.edges.push_back({a, b});
    }
  options.max_distance = 0.1;
  const Surface surface = ball.surface();
  const RemeshResult mesh = remesh(surface, 100, options);
  expect_consistent(surface, mesh);
  EXPECT_EQ(mesh.report.flaws, 0u);
  EXPECT_LE(distance_of(ball.vertices, ball.faces, Surface(mesh.vertices, mesh.faces)), 0.1);
}

TEST(Remesh, AFarLimitOfTheDistanceChangesNothing) {
  const Surface surface = box(3).surface();
  const RemeshResult free = remesh(surface, 200), near = remesh(surface, 200, {.max_distance = 1});
  EXPECT_EQ(free.vertices, near.vertices);
  EXPECT_EQ(free.faces, near.faces);
}

/// A cube with edges rounded by a small radius, from a grid bent around it.
Shape rounded_cube(int n, double radius) {
  Shape shape = box(n);
  for (Vec3& p : shape.vertices) {
    const Vec3 inner = p.cwiseMax(Vec3::Constant(radius)).cwiseMin(Vec3::Constant(1.0 - radius));
    const Vec3 out = p - inner;
    if (out.norm() > 0.0) p = inner + radius * out.normalized();
  }
  return shape;
}

TEST(Remesh, AdaptedVerticesAreNearerToTheSurface) {
  const Shape cube = rounded_cube(24, 0.1);
  const Surface surface = cube.surface();
  const auto apart = [&](const RemeshResult& mesh) {
    return std::max(distance_of(mesh.vertices, mesh.faces, surface),
                    distance_of(cube.vertices, cube.faces, Surface(mesh.vertices, mesh.faces)));
  };
  const RemeshResult even = remesh(surface, 600),
                     adapted = remesh(surface, 600, {.adaptive = true});
  expect_consistent(surface, adapted);
  EXPECT_TRUE(even.density.empty());
  EXPECT_EQ(adapted.density.size(), 3 * surface.face_count());
  EXPECT_EQ(adapted.vertices.size(), 600u);
  EXPECT_EQ(adapted.report.flaws, 0u);
  EXPECT_LE(apart(adapted), 0.7 * apart(even));
  EXPECT_GE(adapted.report.smallest_angle, 30.0);
  EXPECT_GE(adapted.report.distance, 0.9 * apart(adapted));
}

TEST(Remesh, AdaptingChangesNothingWhereTheMeshIsTheSurface) {
  const Surface surface = box(3).surface();
  const RemeshResult even = remesh(surface, 200),
                     adapted = remesh(surface, 200, {.adaptive = true});
  EXPECT_EQ(even.vertices, adapted.vertices);
  EXPECT_TRUE(adapted.density.empty());
  EXPECT_NEAR(adapted.report.distance, 0.0, 1e-12);
}

TEST(Remesh, AdaptingKeepsTheDensityOfTheSurface) {
  Shape shape = rounded_cube(30, 0.1);
  const auto density_of = [&](double high) {  // per face: none at the end of the other half
    std::vector<double> density;
    for (const Face& face : shape.faces) {
      const double x = shape.vertices[static_cast<std::size_t>(face[0])].x();
      density.push_back(x > 0.5 ? high : x > 0.1 ? 1.0 : 0.0);
    }
    return density;
  };
  const auto vertices_there = [](const RemeshResult& mesh) {
    return std::ranges::count_if(mesh.vertices, [](const Vec3& p) { return p.x() > 0.5; });
  };
  const std::vector<double> density = density_of(4.0);
  const Surface surface(shape.vertices, shape.faces, {DensityAt::kFaces, density});
  const RemeshResult mesh = remesh(surface, 400, {.adaptive = true});
  expect_consistent(surface, mesh);
  const Surface even(shape.vertices, shape.faces, {DensityAt::kFaces, density_of(1.0)});
  const auto alike = static_cast<double>(vertices_there(remesh(even, 400, {.adaptive = true})));
  // 239 to 275 over five seeds
  EXPECT_GT(vertices_there(mesh), 235);
  EXPECT_GT(static_cast<double>(vertices_there(mesh)), 1.15 * alike);
  for (std::size_t f = 0; f < density.size(); ++f)
    EXPECT_EQ(density[f] == 0.0, mesh.density[3 * f] == 0.0);
}

TEST(Remesh, AdaptingAndALimitGoTogether) {
  const Surface surface = rounded_cube(24, 0.1).surface();
  const RemeshResult free = remesh(surface, 200, {.adaptive = true});
  const double limit = 0.7 * free.report.distance;
  const RemeshResult near = remesh(surface, 200, {.max_distance = limit, .adaptive = true});
  EXPECT_LE(near.report.distance, limit);
  EXPECT_GT(near.vertices.size(), 200u);
  const RemeshResult even = remesh(surface, 200, {.max_distance = limit});
  EXPECT_LT(near.vertices.size(), even.vertices.size());
}

TEST(Remesh, CellsOfABladeDoNotGoThroughIt) {
  const Surface surface = blade().surface();
  for (const std::size_t count : {60u, 150u, 400u}) {
    const RemeshResult mesh = remesh(surface, count);
    EXPECT_EQ(mesh.report.flaws, 0u);
    EXPECT_EQ(mesh.report.dropped_lines, 0u);
    EXPECT_EQ(mesh.report.euler, 2);
    EXPECT_NEAR(area_of(mesh.vertices, mesh.faces), surface.area(), 1e-9);
  }
}

TEST(Remesh, WallsThinnerThanCellsKeepTheirTopology) {
  DAPPLE_NEEDS_MESH("crank");
  RemeshOptions options;
  options.feature_angle = 180.0;
  const RemeshResult mesh = remesh(shared_mesh("crank").surface(), 250, options);
  EXPECT_EQ(mesh.report.flaws, 0u);
  EXPECT_EQ(mesh.report.euler, -22);
}

/// A pillow in the shape of a star, so flat that its walls meet at its creases at a few degrees.
Surface flat_star(int points, double inner, double thick) {
  std::vector<Vec3> vertices = {Vec3(0, 0, -thick), Vec3(0, 0, thick)};
  std::vector<Face> faces;
  const std::int32_t count = 2 * points;
  for (std::int32_t k = 0; k < count; ++k) {
    const double angle = std::numbers::pi * k / points, radius = k % 2 == 0 ? 1.0 : inner;
    vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
    const std::int32_t a = 2 + k, b = 2 + (k + 1) % count;
    faces.push_back({0, b, a});
    faces.push_back({1, a, b});
  }
  return Surface(vertices, faces);
}

TEST(Remesh, KeepsTheCreasesOfWallsThinnerThanCells) {
  const Surface surface = flat_star(12, 0.5, 0.1);
  const RemeshResult mesh = remesh(surface, 300);
  EXPECT_EQ(mesh.report.flaws, 0u);
  EXPECT_EQ(mesh.report.dropped_lines, 0u);
  EXPECT_EQ(mesh.report.euler, 2);
  EXPECT_NEAR(area_of(mesh.vertices, mesh.faces), surface.area(), 1e-9);
  expect_consistent(surface, mesh);
}

TEST(Remesh, FlatPointsHaveTheirTopologyIfTheirCreasesAreGivenUp) {
  for (const auto& [points, thick] : {std::pair(5, 0.05), std::pair(8, 0.02)}) {
    const RemeshResult mesh = remesh(flat_star(points, 0.3, thick), 100);
    EXPECT_EQ(mesh.report.flaws, 0u) << points;
    EXPECT_EQ(mesh.report.nonmanifold_edges, 0u);
    EXPECT_EQ(mesh.report.euler, 2);
  }
}

/// A flat body with eight fingers.
Shape hand(double thick) {
  return mapped(icosphere(5), [=](const Vec3& p) {
    const double gap = 0.35 * (1.0 - std::cos(8.0 * std::atan2(p[1], p[0])));
    const double scale = 1.0 - gap * (p[0] * p[0] + p[1] * p[1]);
    return Vec3(scale * p[0], scale * p[1], thick * p[2]);
  });
}

TEST(Remesh, NoTriangleOfASmoothBodyFacesAway) {
  RemeshOptions options;
  options.feature_angle = 180.0;
  for (const double thick : {0.05, 0.1})
    for (const std::size_t count : {200u, 400u}) {
      const RemeshResult mesh = remesh(hand(thick).surface(), count, options);
      EXPECT_EQ(mesh.report.flipped, 0u) << thick << ", " << count;
      EXPECT_EQ(mesh.report.flaws, 0u);
      EXPECT_EQ(mesh.vertices.size(), count);
    }
}

/// A block three long whose edge is cut off, ever less along its way.
Surface block_with_a_tapering_chamfer() {
  std::vector<Vec3> vertices;
  for (const auto& [z, width] : {std::pair(0.0, 0.02), std::pair(3.0, 0.001)})
    for (const auto& [x, y] :
         {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(1.0, 1.0 - width),
          std::pair(1.0 - width, 1.0), std::pair(0.0, 1.0)})
      vertices.push_back({x, y, z});
  std::vector<Face> faces;
  for (std::int32_t a = 0; a < 5; ++a) {
    const std::int32_t b = (a + 1) % 5;
    faces.push_back({a, b, b + 5});
    faces.push_back({a, b + 5, a + 5});
  }
  for (std::int32_t k = 1; k < 4; ++k) {
    faces.push_back({0, k + 1, k});
    faces.push_back({5, k + 5, k + 6});
  }
  return Surface(vertices, faces);
}

TEST(Remesh, HasNoNeedlesAlongATaperingChamfer) {
  const Surface surface = block_with_a_tapering_chamfer();
  for (const std::size_t count : {400u, 800u}) {
    const RemeshResult mesh = remesh(surface, count);
    EXPECT_GT(mesh.report.smallest_angle, 3.0) << count;
    EXPECT_EQ(mesh.report.flaws, 0u);
    EXPECT_EQ(mesh.report.flipped, 0u);
    EXPECT_EQ(mesh.report.euler, 2);
    EXPECT_EQ(mesh.vertices.size(), count);
    expect_consistent(surface, mesh);
  }
}

/// A sheet of steep bumps, between which it is folded sharply.
Shape bumps(int cells) {
  return mapped(grid(cells), [](const Vec3& p) {
    const auto wave = [](double x) { return std::abs(std::sin(3.0 * std::numbers::pi * x)); };
    return Vec3(1.0 - p[0], p[1], 1.5 * wave(p[0]) * wave(p[1]));
  });
}

// Any step out of a fold ends close to where it began: one vertex was moved a million times.
TEST(Remesh, MovesOfVerticesInFoldsEnd) {
  for (const int cells : {36, 60}) {
    const Surface surface = bumps(cells).surface();
    expect_consistent(surface, remesh(surface, 150, {.feature_angle = 180.0}));
  }
}

TEST(Remesh, StopsWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW(std::ignore = remesh(blob(3).surface(), 400, {}, &context), Cancelled);
}

}  // namespace
}  // namespace dapple::test
