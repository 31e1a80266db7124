// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>
#include <dapple/domain.hpp>
#include <dapple/poisson_start.hpp>

#include "shapes.hpp"
#include "shared_data.hpp"
#include "voronoi/cell_builder.hpp"

namespace dapple::test {
namespace {

/// So few that cells are computed face by face.
std::size_t few_sites(const Surface& surface) {
  return std::clamp<std::size_t>(surface.face_count() / 5, 1, 500);
}

void expect_same_cells(const Surface& surface, const RestrictedVoronoi& found,
                       const RestrictedVoronoi& expected) {
  const double mean = expected.cells.empty() ? 0.0 : surface.ordered().unit_capacity();
  double second = 0.0;
  for (const Moments& cell : expected.cells) second = std::max(second, cell.second);
  for (std::size_t k = 0; k < expected.cells.size(); ++k) {
    EXPECT_NEAR(found.cells[k].capacity, expected.cells[k].capacity, 1e-12 * mean) << "cell " << k;
    EXPECT_NEAR(found.cells[k].second, expected.cells[k].second, 1e-10 * second) << "cell " << k;
  }
}

bool same_bytes(const RestrictedVoronoi& a, const RestrictedVoronoi& b) {
  for (std::size_t k = 0; k < a.cells.size(); ++k) {
    if (std::memcmp(&a.cells[k], &b.cells[k], sizeof(Moments)) != 0) return false;
    const auto one = a.boundary(k), other = b.boundary(k);
    if (!std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](const CellBoundary& p, const CellBoundary& q) {
                      return p.neighbor == q.neighbor && p.flux == q.flux && p.length == q.length &&
                             p.path_length == q.path_length;
                    }))
      return false;
  }
  return true;
}

RestrictedVoronoi built(CellBuilder& builder, const Sites& sites, Cells cells,
                        bool leaves_gaps = false) {
  RestrictedVoronoi diagram;
  builder.build(sites, nullptr, cells, leaves_gaps, nullptr, diagram);
  return diagram;
}

RestrictedVoronoi flooded(const Surface& surface, const Sites& sites, Cells cells,
                          bool leaves_gaps = false) {
  RestrictedVoronoi diagram;
  CellBuilder(surface).build_by_floods(sites, nullptr, cells, leaves_gaps, nullptr, diagram);
  return diagram;
}

/// The same surface with a density in blobs, which is 0 between them.
Surface in_blobs(const Surface& surface, DensityAt at) {
  const double wave = 9.0 / std::sqrt(surface.area());
  const auto blob = [wave](const Vec3& x) {
    return std::sin(wave * x.x() + 0.4) * std::sin(wave * x.y() + 0.7) +
           std::sin(wave * x.z() + 0.9);
  };
  const std::vector<Vec3> vertices = surface.vertices();
  std::vector<double> density;
  if (at == DensityAt::kVertices)
    for (const Vec3& x : vertices) density.push_back(std::clamp(3.0 * blob(x), 0.0, 1.0));
  else
    for (const auto& [a, b, c] : surface.faces())
      density.push_back(blob((vertices[a] + vertices[b] + vertices[c]) / 3.0) > 0.3 ? 1.0 : 0.0);
  return surface.with_density({at, density});
}

class MarchOn : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, MarchOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(MarchOn, GivesTheCellsOfFloods) {
  const Surface surface = GetParam().surface();
  const Sites sites = poisson_start(surface, few_sites(surface), 5);
  CellBuilder builder(surface);
  for (const Cells cells : {Cells::kEuclidean, Cells::kConnected})
    expect_same_cells(surface, built(builder, sites, cells), flooded(surface, sites, cells));
}

/// What is kept from one evaluation to the next changes no byte.
TEST_P(MarchOn, DoesNotDependOnWhatWasComputedBefore) {
  const Surface surface = GetParam().surface();
  const Sites sites = poisson_start(surface, few_sites(surface), 6);
  const SurfaceDomain domain(surface);
  CellBuilder builder(surface);
  Random random(7);
  for (int k = 0; k < 4; ++k) {
    std::vector<Vec3> points = sites.positions;
    for (Vec3& x : points) x += 0.02 * surface.spacing(sites.size()) * random.in_box();
    const Sites moved = domain.project(points, sites.faces);
    for (const Cells cells : {Cells::kEuclidean, Cells::kConnected}) {
      CellBuilder fresh(surface);
      EXPECT_TRUE(same_bytes(built(builder, moved, cells), built(fresh, moved, cells)));
    }
  }
}

class MarchOnBlobs : public testing::TestWithParam<DensityAt> {};
INSTANTIATE_TEST_SUITE_P(Densities, MarchOnBlobs,
                         testing::Values(DensityAt::kFaces, DensityAt::kVertices));

TEST_P(MarchOnBlobs, GivesTheCellsOfFloods) {
  for (const Shape& shape : {grid(60), torus(90, 45), icosphere(5), soup(torus(90, 45))}) {
    const Surface surface = in_blobs(shape.surface(), GetParam());
    const Sites sites = poisson_start(surface, surface.face_count() / 20, 5);
    CellBuilder builder(surface);
    expect_same_cells(surface, built(builder, sites, Cells::kConnected, /*leaves_gaps=*/true),
                      flooded(surface, sites, Cells::kConnected, /*leaves_gaps=*/true));
  }
}

TEST_P(MarchOnBlobs, DoesNotDependOnWhatWasComputedBefore) {
  const Surface surface = in_blobs(torus(90, 45).surface(), GetParam());
  Sites sites = poisson_start(surface, 400, 6);
  const SurfaceDomain domain(surface);
  CellBuilder builder(surface);
  Random random(7);
  for (const double move : {0.02, 0.02, 0.3, 0.02}) {
    std::vector<Vec3> points = sites.positions;
    for (Vec3& x : points) x += move * surface.spacing(sites.size()) * random.in_box();
    sites = domain.project(points, sites.faces);
    for (const bool leaves_gaps : {true, false}) {
      CellBuilder fresh(surface);
      EXPECT_TRUE(same_bytes(built(builder, sites, Cells::kConnected, leaves_gaps),
                             built(fresh, sites, Cells::kConnected, leaves_gaps)));
    }
  }
}

/// A face that is far from all sites.
std::int32_t farthest_face(const Surface& surface, const Sites& sites) {
  const auto distance = [&](std::int32_t face) {
    const Vec3 x = surface.point(face, Vec3::Constant(1.0 / 3.0));
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& site : sites.positions) least = std::min(least, (site - x).norm());
    return least;
  };
  std::int32_t farthest = 0;
  for (std::size_t f = 1; f < surface.face_count(); ++f)
    if (const auto face = static_cast<std::int32_t>(f); distance(face) > distance(farthest))
      farthest = face;
  return farthest;
}

/// A locked sample may be where nothing has density; its cell looks for density around it.
TEST(FaceMarch, LeavesSitesInGapsToFloods) {
  const Surface surface = in_blobs(grid(60).surface(), DensityAt::kFaces);
  Sites sites = poisson_start(surface, 200, 5);
  sites.faces[0] = farthest_face(surface, sites);
  sites.barycentric[0] = Vec3::Constant(1.0 / 3.0);
  sites.positions[0] = surface.point(sites.faces[0], sites.barycentric[0]);
  CellBuilder builder(surface);
  EXPECT_TRUE(same_bytes(built(builder, sites, Cells::kConnected, /*leaves_gaps=*/true),
                         flooded(surface, sites, Cells::kConnected, /*leaves_gaps=*/true)));
}

/// The crank's walls separate many cells from their sites, which is kept in mind for the next
/// cells.
TEST(FaceMarch, GivesEuclideanCellsAfterDisconnectedOnes) {
  DAPPLE_NEEDS_MESH("crank");
  const Surface surface = shared_mesh("crank").surface();
  const Sites sites = poisson_start(surface, 800, 5);
  CellBuilder builder(surface), fresh(surface);
  const RestrictedVoronoi connected = built(builder, sites, Cells::kConnected);
  EXPECT_TRUE(
      same_bytes(built(builder, sites, Cells::kEuclidean), built(fresh, sites, Cells::kEuclidean)));
  EXPECT_TRUE(same_bytes(built(builder, sites, Cells::kConnected), connected));
}

class MarchOnMesh : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Meshes, MarchOnMesh, testing::ValuesIn(shared_mesh_names()),
                         [](const auto& mesh) { return mesh.param; });

TEST_P(MarchOnMesh, GivesTheCellsOfFloods) {
  DAPPLE_NEEDS_MESH(GetParam());
  const Surface surface = shared_mesh(GetParam()).surface();
  const Sites sites = poisson_start(surface, 800, 5);
  CellBuilder builder(surface);
  for (const Cells cells : {Cells::kEuclidean, Cells::kConnected})
    expect_same_cells(surface, built(builder, sites, cells), flooded(surface, sites, cells));
}

}  // namespace
}  // namespace dapple::test
