// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/sampler.hpp>
#include <map>
#include <numbers>
#include <set>

#include "invariants.hpp"
#include "shared_data.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

std::span<const std::int32_t> polygon(const Mosaic& mosaic, std::size_t k) {
  const auto first = static_cast<std::size_t>(mosaic.starts[k]);
  return std::span(mosaic.corners)
      .subspan(first, static_cast<std::size_t>(mosaic.starts[k + 1]) - first);
}

const Vec3& vertex(const Mosaic& mosaic, std::int32_t v) {
  return mosaic.vertices[static_cast<std::size_t>(v)];
}

Vec3 twice_area_vector(const Mosaic& mosaic, std::size_t k) {
  const auto corners = polygon(mosaic, k);
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < corners.size(); ++c)
    sum += vertex(mosaic, corners[c]).cross(vertex(mosaic, corners[(c + 1) % corners.size()]));
  return sum;
}

double area(const Mosaic& mosaic, TileSide side = TileSide::kTop) {
  double sum = 0.0;
  for (std::size_t k = 0; k < mosaic.size(); ++k)
    if (mosaic.sides[k] == side) sum += 0.5 * twice_area_vector(mosaic, k).norm();
  return sum;
}

double volume(const Mosaic& mosaic) {
  double six = 0.0;
  for (std::size_t k = 0; k < mosaic.size(); ++k) {
    const auto corners = polygon(mosaic, k);
    for (std::size_t c = 2; c < corners.size(); ++c)
      six += vertex(mosaic, corners[0])
                 .dot(vertex(mosaic, corners[c - 1]).cross(vertex(mosaic, corners[c])));
  }
  return six / 6.0;
}

double tile_area(const Mosaic& mosaic) {
  double sum = 0.0;
  for (const Tile& tile : mosaic.tiles) sum += tile.area;
  return sum;
}

/// How often polygons traverse each edge, by direction.
std::map<Edge, int> runs(const Mosaic& mosaic) {
  std::map<Edge, int> result;
  for (std::size_t k = 0; k < mosaic.size(); ++k) {
    const auto corners = polygon(mosaic, k);
    for (std::size_t c = 0; c < corners.size(); ++c)
      ++result[{corners[c], corners[(c + 1) % corners.size()]}];
  }
  return result;
}

/// Check that polygons have at least three different corners, tiles have no common vertices, no
/// edge is traversed twice, and the border consists of closed loops.
void check_loops(const Mosaic& mosaic) {
  ASSERT_EQ(mosaic.starts.size(), mosaic.size() + 1);
  std::map<std::int32_t, std::int32_t> owner;
  for (std::size_t k = 0; k < mosaic.size(); ++k) {
    const auto corners = polygon(mosaic, k);
    EXPECT_GE(corners.size(), 3u);
    EXPECT_EQ(std::set(corners.begin(), corners.end()).size(), corners.size()) << "polygon " << k;
    for (const std::int32_t v : corners)
      EXPECT_EQ(owner.try_emplace(v, mosaic.sites[k]).first->second, mosaic.sites[k]);
  }
  const std::map<Edge, int> uses = runs(mosaic);
  std::map<std::int32_t, int> out;
  std::map<std::int32_t, int> in;
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1) << edge.first << " " << edge.second;
    if (uses.count({edge.second, edge.first})) continue;
    EXPECT_EQ(++out[edge.first], 1) << "vertex " << edge.first;
    EXPECT_EQ(++in[edge.second], 1) << "vertex " << edge.second;
  }
  EXPECT_EQ(out.size(), in.size());
}

void expect_closed(const Mosaic& mosaic) {
  const std::map<Edge, int> uses = runs(mosaic);
  for (const auto& [edge, count] : uses)
    EXPECT_EQ(uses.count({edge.second, edge.first}), 1u) << edge.first << " " << edge.second;
}

double shortest_edge(const Mosaic& mosaic) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [edge, count] : runs(mosaic))
    least = std::min(least, (vertex(mosaic, edge.first) - vertex(mosaic, edge.second)).norm());
  return least;
}

Samples bound(const Shape& shape, const Sites& sites) {
  const Surface surface = shape.surface();
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto& [a, b, c] = shape.faces[static_cast<std::size_t>(sites.faces[k])];
    const Vec3& o = shape.vertices[static_cast<std::size_t>(a)];
    const Vec3 u = shape.vertices[static_cast<std::size_t>(b)] - o;
    const Vec3 v = shape.vertices[static_cast<std::size_t>(c)] - o;
    const Vec3 p = sites.positions[k] - o;
    const double d = u.dot(u) * v.dot(v) - u.dot(v) * u.dot(v);
    const double s = (v.dot(v) * u.dot(p) - u.dot(v) * v.dot(p)) / d;
    const double t = (u.dot(u) * v.dot(p) - u.dot(v) * u.dot(p)) / d;
    weights.emplace_back(std::max(0.0, 1.0 - s - t), std::max(0.0, s), std::max(0.0, t));
  }
  return bind_samples(surface, sites.faces, weights);
}

/// One sample in the middle of each quarter of the unit square.
Samples quarters(const Surface& surface) {
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (const double x : {0.25, 0.75})
    for (const double y : {0.25, 0.75})
      for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f) {
        const Face corners = surface.faces()[static_cast<std::size_t>(f)];
        const std::vector<Vec3> all = surface.vertices();
        const Vec3& o = all[static_cast<std::size_t>(corners[0])];
        Eigen::Matrix2d edges;
        edges << (all[static_cast<std::size_t>(corners[1])] - o).head<2>(),
            (all[static_cast<std::size_t>(corners[2])] - o).head<2>();
        const Vec2 w = edges.inverse() * (Vec2(x, y) - o.head<2>());
        if (w.minCoeff() < -1e-12 || w.sum() > 1.0 + 1e-12) continue;
        faces.push_back(f);
        weights.emplace_back(1.0 - w.sum(), w.x(), w.y());
        break;
      }
  return bind_samples(surface, faces, weights);
}

class MosaicOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, MosaicOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(MosaicOn, CoversTheSurfaceWithClosedLoops) {
  const Surface surface = GetParam().surface();
  for (const std::size_t count : {1u, 5u, 60u})
    for (const bool merge : {false, true})
      for (const Cells cells : {Cells::kConnected, Cells::kEuclidean}) {
        SampleOptions sampling;
        sampling.optimizer.max_evaluations = 4;
        MosaicOptions options;
        options.merge = merge;
        options.shortest_edge = 0.0;
        options.cells = cells;
        const Mosaic found = mosaic(surface, sample(surface, count, sampling), options);
        ASSERT_EQ(found.tiles.size(), count);
        check_loops(found);
        EXPECT_NEAR(area(found), surface.area(), 1e-6 * surface.area());
        EXPECT_NEAR(tile_area(found), surface.area(), 1e-6 * surface.area());
      }
}

using Place = std::array<double, 3>;

/// Edges with a polygon on one side only, after merging vertices at the same place.
std::size_t open_edges(const Mosaic& mosaic) {
  std::map<std::pair<Place, Place>, int> sides;
  const auto place = [&](std::int32_t v) {
    const Vec3& p = vertex(mosaic, v);
    return Place{p[0], p[1], p[2]};
  };
  for (std::size_t k = 0; k < mosaic.size(); ++k) {
    const auto corners = polygon(mosaic, k);
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Place a = place(corners[c]), b = place(corners[(c + 1) % corners.size()]);
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  return static_cast<std::size_t>(
      std::ranges::count_if(sides, [](const auto& side) { return side.second != 0; }));
}

TEST(Mosaic, HasTheSamePointsWhereTilesTouchWithoutGrout) {
  for (const Shape& shape : {torus(48, 24), box(1), box(5), blob(4)}) {
    const Surface surface = shape.surface();
    for (const double shortest : {0.0, 1e-3, 0.1})
      for (const bool merge : {false, true}) {
        const Samples samples = sample(surface, 300, {.optimizer = {.max_evaluations = 8}});
        const Mosaic tiles = mosaic(surface, samples, {.shortest_edge = shortest, .merge = merge});
        EXPECT_EQ(open_edges(tiles), 0u) << shortest;
      }
  }
}

TEST_P(MosaicOn, BuildsClosedBodiesWithoutShortEdges) {
  const Surface surface = GetParam().surface();
  MosaicOptions options;
  options.grout = 0.1 * surface.spacing(40);
  options.shortest_edge = 0.02;
  options.thickness = 0.1 * surface.spacing(40);
  const Samples samples = sample(surface, 40);
  const Mosaic found = mosaic(surface, samples, options);
  expect_closed(found);
  check_loops(found);
  options.thickness = 0.0;
  const Mosaic flat = mosaic(surface, samples, options);
  EXPECT_GE(shortest_edge(flat), options.shortest_edge * surface.spacing(40));
  check_loops(flat);
}

TEST(Mosaic, LeavesTheGroutBetweenNeighborsAndNoneAtTheBorder) {
  for (const int cells : {1, 3, 8}) {
    const Surface surface = grid(cells).surface();
    MosaicOptions options;
    options.grout = 0.1;
    const Mosaic found = mosaic(surface, quarters(surface), options);
    ASSERT_EQ(found.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(polygon(found, k).size(), 4u) << "one square, whatever faces it crosses";
      EXPECT_NEAR(0.5 * twice_area_vector(found, k).z(), 0.45 * 0.45, 1e-12);
      EXPECT_NEAR(found.tiles[k].area, 0.45 * 0.45, 1e-12);
      EXPECT_NEAR(found.tiles[k].cell_area, 0.25, 1e-12);
      EXPECT_EQ(found.tiles[k].parts, 1);
      EXPECT_EQ(found.tiles[k].loops, 1);
    }
  }
}

TEST(Mosaic, DrawsEachTileBackByItsInset) {
  const Surface surface = grid(4).surface();
  MosaicOptions options;
  options.grout = 0.02;
  options.insets = {0.0, 0.01, 0.1, 0.5};
  const Mosaic found = mosaic(surface, quarters(surface), options);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(found.tiles[k].area, std::pow(0.49 - options.insets[k], 2), 1e-12);
  EXPECT_EQ(found.tiles[3].parts, 0) << "an inset as wide as the cell leaves nothing";
  EXPECT_EQ(found.tiles[3].area, 0.0);
  EXPECT_NEAR(found.tiles[3].cell_area, 0.25, 1e-12);
}

/// A random point is on the tile of its nearest site exactly if it is at least half the grout away
/// from each bisector plane of that site.
TEST(Mosaic, KeepsWhatIsFartherThanHalfTheGroutFromEveryPlane) {
  constexpr std::size_t kPoints = 40000;
  for (const Shape& shape : {blob(3), box(3), grid(5), tube(12, 6)}) {
    const Surface surface = shape.surface();
    const Samples samples = sample(surface, 30);
    MosaicOptions options;
    options.cells = Cells::kEuclidean;
    options.grout = 0.2 * surface.spacing(30);
    const Mosaic found = mosaic(surface, samples, options);
    Random random(7);
    const Sites points = random_sites(shape, kPoints, random);
    std::size_t kept = 0;
    for (const Vec3& p : points.positions) {
      const auto nearest = static_cast<std::size_t>(
          std::min_element(samples.positions.begin(), samples.positions.end(),
                           [&](const Vec3& a, const Vec3& b) {
                             return (a - p).squaredNorm() < (b - p).squaredNorm();
                           }) -
          samples.positions.begin());
      double least = std::numeric_limits<double>::infinity();
      for (const Vec3& other : samples.positions) {
        const Vec3 way = other - samples.positions[nearest];
        if (way.isZero()) continue;
        const Vec3 middle = 0.5 * (other + samples.positions[nearest]);
        least = std::min(least, (middle - p).dot(way.normalized()));
      }
      kept += least >= 0.5 * options.grout ? 1 : 0;
    }
    const double share = static_cast<double>(kept) / kPoints;
    EXPECT_NEAR(tile_area(found) / surface.area(), share, 0.01) << shape.name;
    EXPECT_LT(share, 0.9) << "the grout takes something";
  }
}

TEST(Mosaic, SaysWhatBecameOfACell) {
  const Mosaic shell = mosaic(box(2).surface(), sample(box(2).surface(), 1));
  EXPECT_EQ(shell.tiles[0].parts, 1);
  EXPECT_EQ(shell.tiles[0].loops, 0) << "a whole closed component";
  const Mosaic sleeve = mosaic(tube(12, 3).surface(), sample(tube(12, 3).surface(), 1));
  EXPECT_EQ(sleeve.tiles[0].parts, 1);
  EXPECT_EQ(sleeve.tiles[0].loops, 2);
}

/// A square with a square hole in its middle, as eight triangles in one plane.
Shape frame() {
  Shape shape{"frame", {}, {}};
  for (const double s : {1.0, 0.4})
    for (const auto& [x, y] : {std::pair(-s, -s), {s, -s}, {s, s}, {-s, s}})
      shape.vertices.emplace_back(x, y, 0.0);
  for (std::int32_t k = 0; k < 4; ++k) {
    const std::int32_t next = (k + 1) % 4;
    shape.faces.push_back({k, next, next + 4});
    shape.faces.push_back({k, next + 4, k + 4});
  }
  return shape;
}

TEST(Mosaic, KeepsAHoleInACell) {
  const Surface surface = frame().surface();
  MosaicOptions options;
  options.thickness = 0.1;
  const Mosaic found = mosaic(surface, sample(surface, 1), options);
  EXPECT_EQ(found.tiles[0].parts, 1);
  EXPECT_EQ(found.tiles[0].loops, 2);
  check_loops(found);
  expect_closed(found);
  EXPECT_NEAR(area(found), 4.0 - 0.64, 1e-12);
  EXPECT_NEAR(area(found, TileSide::kWall), 0.1 * (8.0 + 3.2), 1e-12);
  EXPECT_NEAR(volume(found), 0.1 * (4.0 - 0.64), 1e-12);
}

TEST(Mosaic, MitresTheTopOverCreases) {
  MosaicOptions options;
  options.thickness = 0.25;
  const Surface surface = box(2).surface();
  const Mosaic shell = mosaic(surface, sample(surface, 1), options);
  expect_closed(shell);
  EXPECT_NEAR(area(shell, TileSide::kTop), 6.0 * 1.5 * 1.5, 1e-9);
  EXPECT_NEAR(area(shell, TileSide::kBottom), 6.0, 1e-9);
  EXPECT_NEAR(volume(shell), 1.5 * 1.5 * 1.5 - 1.0, 1e-9);
}

TEST(Mosaic, MergesWhatLiesInOnePlane) {
  const Surface surface = box(8).surface();
  const Samples samples = sample(surface, 50);
  const Mosaic merged = mosaic(surface, samples);
  MosaicOptions options;
  options.merge = false;
  const Mosaic pieces = mosaic(surface, samples, options);
  EXPECT_LT(merged.size(), 50u * 3u)
      << "a polygon for each side of the box that a cell has part of";
  EXPECT_GT(pieces.size(), 50u * 10u);
  EXPECT_NEAR(area(merged), area(pieces), 1e-12);
  for (std::size_t k = 0; k < merged.size(); ++k) {
    const Vec3 normal = twice_area_vector(merged, k).normalized();
    EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0, 1e-9);
  }
}

TEST(Mosaic, LiesInTheSurfaceAndTurnsWithIt) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  MosaicOptions options;
  options.grout = 0.1 * surface.spacing(100);
  const Mosaic found = mosaic(surface, sample(surface, 100), options);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Face& face = shape.faces[static_cast<std::size_t>(found.faces[k])];
    const auto at = [&](std::size_t c) {
      return shape.vertices[static_cast<std::size_t>(face[c])];
    };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    EXPECT_GT(twice_area_vector(found, k).dot(normal), 0.0);
    for (const std::int32_t v : polygon(found, k))
      EXPECT_NEAR((vertex(found, v) - at(0)).dot(normal), 0.0,
                  options.shortest_edge * surface.spacing(100));
  }
}

TEST(Mosaic, HandlesDegenerateSites) {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const Shape shape = random_shape(random);
    const Samples samples = bound(shape, degenerate_sites(shape, 25, random));
    const Surface surface = shape.surface();
    MosaicOptions options;
    options.shortest_edge = 0.0;
    const Mosaic whole = mosaic(surface, samples, options);
    check_loops(whole);
    EXPECT_NEAR(area(whole), surface.area(), 1e-6 * surface.area()) << shape.name;
    options.shortest_edge = 0.02;
    options.grout = 0.1 * surface.spacing(25);
    options.thickness = 0.01;
    const Mosaic body = mosaic(surface, samples, options);
    check_loops(body);
    expect_closed(body);
  }
}

/// A bisector that cuts a needle near its tip crosses two edges at the same place.
TEST(Mosaic, OfNeedlesHasNoPolygonThatMeetsItself) {
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    const double width = std::pow(10.0, random.between(-9.0, -6.0));
    const Vec3 tip(random.uniform() * width, 1.0, 0.5);
    const Shape shape{"needle", {Vec3::Zero(), {width, 0, 0}, tip}, {{0, 1, 2}}};
    const Surface needle = shape.surface();
    const std::vector<Vec3> weights = {Vec3::UnitX(), Vec3::UnitY()};
    const Samples samples = bind_samples(needle, std::vector<std::int32_t>{0, 0}, weights);
    check_loops(mosaic(needle, samples, {.shortest_edge = 0.0}));
  }
}

TEST(Mosaic, GivesTheSameBytesForAnyNumberOfThreads) {
  const Surface surface = blob(4).surface();
  const Samples samples = sample(surface, 500);
  MosaicOptions options;
  options.grout = 0.01;
  options.thickness = 0.01;
  options.threads = 1;
  const Mosaic base = mosaic(surface, samples, options);
  for (const int threads : {2, 8, 0}) {
    options.threads = threads;
    const Mosaic again = mosaic(surface, samples, options);
    EXPECT_TRUE(same_bytes(again.vertices, base.vertices));
    EXPECT_EQ(again.corners, base.corners);
    EXPECT_EQ(again.starts, base.starts);
    EXPECT_EQ(again.sites, base.sites);
  }
}

TEST(Mosaic, NamesWhatIsWrong) {
  const Surface surface = grid(2).surface();
  const Samples samples = quarters(surface);
  const auto run = [&](const MosaicOptions& options) {
    return [&surface, &samples, options] { (void)mosaic(surface, samples, options); };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>(run({.grout = -1.0}), {"grout", "-1"});
  expect_message<ArgumentError>(run({.grout = nan}), {"grout", "nan"});
  expect_message<ArgumentError>(run({.thickness = -0.5}), {"thickness", "-0.5"});
  expect_message<ArgumentError>(run({.shortest_edge = -1e-3}), {"shortest_edge"});
  expect_message<ArgumentError>(run({.insets = {0.0, 0.1}}), {"insets", "2", "samples", "4"});
  expect_message<ArgumentError>(run({.insets = {0.0, 0.1, -0.2, -0.3}}), {"insets[2]", "-0.2"});
}

TEST(Mosaic, OfNoSamplesIsEmpty) {
  const Mosaic found = mosaic(grid(2).surface(), Samples());
  EXPECT_EQ(found.size(), 0u);
  EXPECT_EQ(found.starts, std::vector<std::int32_t>{0});
}

TEST(Mosaic, CoversRealMeshes) {
  for (const char* name : {"bunny", "fandisk", "crank", "face", "lilium", "truck"}) {
    DAPPLE_NEEDS_MESH(name);
    const Surface surface = shared_mesh(name).surface();
    SampleOptions sampling;
    sampling.optimizer.max_evaluations = 12;
    const Samples samples = sample(surface, 800, sampling);
    MosaicOptions options;
    options.shortest_edge = 0.0;
    const Mosaic whole = mosaic(surface, samples, options);
    check_loops(whole);
    EXPECT_NEAR(area(whole), surface.area(), 1e-6 * surface.area()) << name;
    options.shortest_edge = 1e-3;
    options.grout = 0.1 * samples.report.spacing;
    options.thickness = 0.1 * samples.report.spacing;
    const Mosaic body = mosaic(surface, samples, options);
    check_loops(body);
    expect_closed(body);
  }
}

}  // namespace
}  // namespace dapple::test
