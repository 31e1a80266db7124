// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <dapple/poisson_start.hpp>
#include <dapple/restricted_voronoi.hpp>

#include "base/random.hpp"
#include "optimize/capacity_jacobian.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr double kFactor = 0.75;

struct Fixture {
  Fixture() : surface(blob(3).surface()), sites(poisson_start(surface, 60, 2)) {
    diagram = restricted_voronoi(surface, sites, Cells::kEuclidean);
    Random random(5);
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const Vec3 normal(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
      bases.push_back(tangent_basis(normal.normalized()));
      v.push_back({random.uniform() - 0.5, random.uniform() - 0.5});
    }
  }

  /// The matrix by its definition: a row per cell, two columns per site.
  [[nodiscard]] Eigen::MatrixXd dense() const {
    const auto count = static_cast<Eigen::Index>(sites.size());
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, 2 * count);
    for (Eigen::Index i = 0; i < count; ++i)
      for (const CellBoundary& side : diagram.boundary(static_cast<std::size_t>(i))) {
        const Eigen::RowVector2d a =
            kFactor * side.flux.transpose() * bases[static_cast<std::size_t>(i)];
        result.block<1, 2>(i, 2 * i) += a;
        result.block<1, 2>(side.neighbor, 2 * i) -= a;
      }
    return result;
  }

  Surface surface;
  Sites sites;
  RestrictedVoronoi diagram;
  std::vector<TangentBasis> bases;
  TangentVectors v;
};

Eigen::VectorXd flat(const TangentVectors& v) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(2 * v.size()));
  for (std::size_t k = 0; k < v.size(); ++k)
    result.segment<2>(static_cast<Eigen::Index>(2 * k)) << v[k].u, v[k].v;
  return result;
}

void expect_product(const Fixture& f) {
  const CapacityJacobian jacobian(f.diagram, {}, f.bases, kFactor);
  TangentVectors found(f.v.size(), {1.0, 2.0});
  const TangentVectors before = found;
  std::vector<double> change;
  jacobian.add_product(f.v, change, found);
  const Eigen::MatrixXd j = f.dense();
  const Eigen::VectorXd expected = flat(before) + j.transpose() * (j * flat(f.v));
  EXPECT_LT((flat(found) - expected).norm(), 1e-12 * expected.norm());
}

TEST(CapacityJacobian, MultipliesByItsDefinition) { expect_product(Fixture()); }

/// Rounding and uncovered faces can leave a boundary in the list of one cell only.
TEST(CapacityJacobian, TakesBoundariesThatOnlyOneSideLists) {
  Fixture f;
  for (const std::size_t cell : {3u, 17u, 18u}) --f.diagram.rows[cell].count;
  expect_product(f);
}

/// Around a torus two cells can have several boundaries in common.
TEST(CapacityJacobian, AddsSeveralBoundariesWithOneNeighbor) {
  Fixture f;
  const std::size_t cell = 5;
  std::vector<CellBoundary> row(f.diagram.boundary(cell).begin(), f.diagram.boundary(cell).end());
  row.push_back(row[0]);
  row.back().flux *= 0.5;
  f.diagram.rows[cell] = {f.diagram.boundaries.size(), row.size()};
  f.diagram.boundaries.insert(f.diagram.boundaries.end(), row.begin(), row.end());
  expect_product(f);
}

TEST(CapacityJacobian, KnowsItsDiagonalBlocks) {
  const Fixture f;
  const CapacityJacobian jacobian(f.diagram, {}, f.bases, kFactor);
  std::vector<TangentBlock> blocks(f.sites.size());
  jacobian.add_blocks(blocks);
  const Eigen::MatrixXd j = f.dense();
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const auto columns = j.middleCols<2>(static_cast<Eigen::Index>(2 * k));
    const Eigen::Matrix2d expected = columns.transpose() * columns;
    EXPECT_NEAR(blocks[k].uu, expected(0, 0), 1e-12 * expected.norm()) << "site " << k;
    EXPECT_NEAR(blocks[k].uv, expected(0, 1), 1e-12 * expected.norm()) << "site " << k;
    EXPECT_NEAR(blocks[k].vv, expected(1, 1), 1e-12 * expected.norm()) << "site " << k;
  }
}

}  // namespace
}  // namespace dapple::test
