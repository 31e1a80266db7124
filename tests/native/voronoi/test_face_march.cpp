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

RestrictedVoronoi built(CellBuilder& builder, const Sites& sites, Cells cells) {
  RestrictedVoronoi diagram;
  builder.build(sites, nullptr, cells, /*leaves_gaps=*/false, nullptr, diagram);
  return diagram;
}

RestrictedVoronoi flooded(const Surface& surface, const Sites& sites, Cells cells) {
  RestrictedVoronoi diagram;
  CellBuilder(surface).build_by_floods(sites, nullptr, cells, false, nullptr, diagram);
  return diagram;
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
