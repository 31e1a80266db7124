// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/analysis.hpp>
#include <dapple/domain.hpp>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <iostream>
#include <numeric>

#include "base/parallel.hpp"
#include "invariants.hpp"
#include "shared_data.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

double total_area(const RestrictedVoronoi& diagram) {
  return std::accumulate(diagram.cells.begin(), diagram.cells.end(), 0.0,
                         [](double sum, const Moments& cell) { return sum + cell.area; });
}

class ConnectedCells : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ConnectedCells, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ConnectedCells, PartitionTheSurface) {
  const Surface surface = GetParam().surface();
  for (const std::size_t count : {1u, 2u, 7u, 60u, 400u}) {
    Random random(count);
    const Sites sites = random_sites(GetParam(), count, random, true);
    const RestrictedVoronoi diagram = restricted_voronoi(surface, sites, Cells::kConnected);
    EXPECT_NEAR(total_area(diagram), surface.area(), 1e-10 * surface.area()) << count << " sites";
  }
}

/// A component with a site belongs only to sites on it.
TEST_P(ConnectedCells, StayOnTheirComponents) {
  const Surface surface = GetParam().surface();
  Random random(5);
  const Sites sites = random_sites(GetParam(), 60, random, true);
  const auto component = [&](std::int32_t face) {
    return surface.ordered().component(surface.ordered().ordered_face(face));
  };
  std::vector<bool> inhabited(static_cast<std::size_t>(surface.ordered().components()), false);
  for (const std::int32_t face : sites.faces)
    inhabited[static_cast<std::size_t>(component(face))] = true;
  for (const CellPolygon& piece : restricted_voronoi_polygons(surface, sites, Cells::kConnected)) {
    if (!inhabited[static_cast<std::size_t>(component(piece.face))]) continue;
    EXPECT_EQ(component(piece.face), component(sites.faces[static_cast<std::size_t>(piece.site)]))
        << "site " << piece.site << ", face " << piece.face;
  }
}

TEST(ConnectedCells, AreEuclideanWhereNothingIsInTheWay) {
  const Shape shape = blob(3);
  Random random(3);
  const Sites sites = random_sites(shape, 200, random, true);
  const Surface surface = shape.surface();
  const Energy a = evaluate_energy(surface, sites, 30.0, Cells::kConnected);
  const Energy b = evaluate_energy(surface, sites, 30.0, Cells::kEuclidean);
  EXPECT_EQ(a.total, b.total);
}

/// Two sheets much nearer to each other than the spacing: a Euclidean cell covers both.
TEST(ConnectedCells, GiveEachOfTwoSheetsTheSame) {
  const Surface surface = two_sheets(20, 0.005).surface();
  const Samples samples = sample(surface, 300);
  const auto upper = std::count_if(samples.positions.begin(), samples.positions.end(),
                                   [](const Vec3& p) { return p.z() > 0.0025; });
  EXPECT_NEAR(static_cast<double>(upper), 150.0, 1.5);
  EXPECT_LT(samples.report.evenness.capacity_variation, 0.01);
  EXPECT_GT(samples.report.evenness.alpha_min, 0.5);
}

/// The search is short as well. On the crank the energy jumps, and a single run takes 23 to 52
/// evaluations by chance, so the mean of several runs is tested.
TEST(ConnectedCells, AreEvenOnThinWalls) {
  struct Limit {
    const char* name;
    double variation;
    int evaluations;
    int runs;
  };
  for (const auto& [name, variation, evaluations, runs] :
       {Limit{"lilium", 0.03, 12, 1}, {"crank", 0.05, 34, 9}}) {
    DAPPLE_NEEDS_MESH(name);
    const Surface surface = shared_mesh(name).surface();
    int sum = 0;
    SampleOptions options;
    for (int run = 0; run < runs; ++run) {
      options.seed = static_cast<std::uint64_t>(run);
      const Report report = sample(surface, 2000, options).report;
      std::cout << name << ": capacity variation " << report.evenness.capacity_variation << ", "
                << report.evaluations << " evaluations\n";
      EXPECT_LT(report.evenness.capacity_variation, variation) << name;
      sum += report.evaluations;
    }
    EXPECT_LE(sum, runs * evaluations) << name;
  }
}

TEST(ConnectedCells, AreTheSameForAnyNumberOfThreads) {
  const Surface surface = two_sheets(12, 0.005).surface();
  const Samples one = sample(surface, 150, {.threads = 1});
  const Samples two = sample(surface, 150, {.threads = 2});
  EXPECT_EQ(one.positions, two.positions);
}

/// A step through the wall that ends nearer to the other sheet.
TEST(SurfaceDomain, DoesNotHopToAnotherSheet) {
  const Surface surface = two_sheets(8, 0.05).surface();
  const SurfaceDomain domain(surface);
  const Projection start = Projector(surface).project(std::vector<Vec3>{{0.4, 0.4, 0.0}});
  ASSERT_EQ(start.positions[0].z(), 0.0);
  const Sites moved = domain.project(std::vector<Vec3>{{0.42, 0.4, 0.04}}, start.faces);
  EXPECT_NEAR(moved.positions[0].z(), 0.0, 1e-15);
  EXPECT_NEAR(moved.positions[0].x(), 0.42, 1e-12);
}

/// Sheets with the same normal, which can be distinguished only by walking along the surface.
TEST(SurfaceDomain, WalksWithoutHoppingBetweenSheetsThatLookAlike) {
  Shape shape = grid(8);
  const Shape upper = grid(8);
  const auto count = static_cast<std::int32_t>(shape.vertices.size());
  for (const Vec3& x : upper.vertices) shape.vertices.push_back(x + Vec3(0.0, 0.0, 0.05));
  for (const Face& f : upper.faces)
    shape.faces.push_back({f[0] + count, f[1] + count, f[2] + count});
  const Surface surface = shape.surface();
  const SurfaceDomain domain(surface, Cells::kConnected);
  const std::vector<std::int32_t> from = {0};
  const Sites moved = domain.project(std::vector<Vec3>{{0.42, 0.4, 0.04}}, from);
  EXPECT_NEAR((moved.positions[0] - Vec3(0.42, 0.4, 0.0)).norm(), 0.0, 1e-12);
}

/// On a ball all near faces are reachable.
TEST(SurfaceDomain, WalksToTheNearestPoint) {
  const Surface surface = icosphere(4).surface();
  const SurfaceDomain walking(surface, Cells::kConnected);
  const Sites start = random_start(surface, 200, 1);
  std::vector<Vec3> points = start.positions;
  for (Vec3& point : points) point += Vec3(0.05, 0.02, 0.03);
  const Sites walked = walking.project(points, start.faces);
  const Projection nearest = Projector(surface).project(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_NEAR((walked.positions[k] - nearest.positions[k]).norm(), 0.0, 1e-9) << "point " << k;
}

/// The construction of a projector checks for cancellation.
TEST(SurfaceDomain, MakesNoProjectorBeforeItIsNeeded) {
  const SurfaceDomain domain(blob(3).surface(), Cells::kConnected);
  Context cancelled;
  cancelled.cancel();
  EXPECT_EQ(domain.project({}, {}, &cancelled).size(), 0u);
  const std::vector<Vec3> one(1, Vec3::Zero());
  EXPECT_THROW((void)domain.project(one, {}, &cancelled), Cancelled);
}

TEST(SurfaceDomain, KeepsSitesWhereThereIsDensity) {
  const Shape shape = with_density(grid(16), [](const Vec3& p) { return p.x() < 0.5 ? 0.0 : 1.0; });
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, 200);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const FaceGeometry& face =
        surface.ordered().geometry(surface.ordered().ordered_face(samples.faces[k]));
    EXPECT_GT(face.moments.capacity, 0.0) << "sample " << k << " at " << samples.positions[k].x();
  }
}

/// A cloth folded flat onto itself. Both halves are one component at the same place; where it is
/// folded twice, they also have the same normal.
TEST(Domain, StepsDoNotHopToAnotherSheetAtTheSamePlace) {
  Shape shape = grid(8);
  const auto count = static_cast<std::int32_t>(shape.faces.size());
  const auto vertices = static_cast<std::int32_t>(shape.vertices.size());
  const Shape copy = shape;
  shape = joined(shape, copy);
  for (std::size_t f = static_cast<std::size_t>(count); f < shape.faces.size(); ++f)
    for (std::int32_t& v : shape.faces[f])
      // vertices on the fold
      if (shape.vertices[static_cast<std::size_t>(v)].x() == 0.0) v -= vertices;
  const Surface surface(shape.vertices, shape.faces, Density{}, {.merge_doubled = false});
  ASSERT_EQ(surface.ordered().components(), 1);
  Random random(1);
  const Sites sites = random_sites(shape, 200, random, true);
  std::vector<Vec3> moved;
  moved.reserve(sites.size());
  for (const Vec3& p : sites.positions) moved.emplace_back(p + Vec3(0.04, 0.03, 0.01));
  const Sites found = SurfaceDomain(surface).project(moved, sites.faces);
  for (std::size_t k = 0; k < sites.size(); ++k)
    EXPECT_EQ(found.faces[k] < count, sites.faces[k] < count) << "site " << k;
}

/// What is kept of the last sites of one set must not change the cells of another.
TEST(SurfaceDomain, CellsDoNotDependOnTheirSet) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const SurfaceDomain domain(surface);
  Random random(3);
  std::vector<Sites> sets;
  for (const std::size_t count : {30u, 30u, 200u})
    sets.push_back(random_sites(shape, count, random, true));
  RestrictedVoronoi diagram;
  for (int round = 0; round < 3; ++round)
    for (std::size_t k = 0; k < sets.size(); ++k) {
      domain.update_cells(diagram, sets[k], k, nullptr);
      const RestrictedVoronoi alone = SurfaceDomain(surface).cells(sets[k], nullptr);
      for (std::size_t i = 0; i < sets[k].size(); ++i)
        EXPECT_EQ(diagram.cells[i].capacity, alone.cells[i].capacity)
            << round << " " << k << " " << i;
      std::swap(sets[k].positions[0], sets[k].positions[1]);
      std::swap(sets[k].faces[0], sets[k].faces[1]);
    }
}

/// Many threads need the projector at once. The thread that constructs it must not, while it waits
/// for its own tasks, start another task that waits for the projector.
TEST(SurfaceDomain, IsFirstUsedByManyTasksAtOnce) {
  const Surface surface = icosphere(5).surface();
  const std::vector<Vec3> point = {{2.0, 0.1, 0.3}};
  for (int round = 0; round < 20; ++round) {
    const SurfaceDomain domain(surface);
    parallel_chunks(64, 1, [&](std::size_t, std::size_t) {
      EXPECT_NEAR(domain.project(point, {}).positions[0].norm(), 1.0, 1e-2);
    });
  }
}

}  // namespace
}  // namespace dapple::test
