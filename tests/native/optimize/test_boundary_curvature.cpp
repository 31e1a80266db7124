// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <dapple/energy.hpp>
#include <dapple/poisson_start.hpp>

#include "optimize/boundary_curvature.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 40;

/// Sites of a flat square, where boundaries are straight.
struct Fixture {
  explicit Fixture(double density = 1.0)
      : surface(with_density(grid(8), [=](const Vec3&) { return density; }).surface()),
        sites(poisson_start(surface, kCount, 4)) {
    diagram = restricted_voronoi(surface, sites, Cells::kEuclidean);
    bases.assign(kCount, tangent_basis(Vec3::UnitZ()));
    curvature.update(diagram, {}, bases, 1.0);
  }

  /// 2 diag(m) - B, column by column.
  [[nodiscard]] Eigen::MatrixXd hessian() const {
    const auto size = static_cast<Eigen::Index>(2 * kCount);
    Eigen::MatrixXd result(size, size);
    for (Eigen::Index column = 0; column < size; ++column) {
      TangentVectors v(kCount);
      const auto site = static_cast<std::size_t>(column / 2);
      (column % 2 == 0 ? v[site].u : v[site].v) = 1.0;
      for (std::size_t k = 0; k < kCount; ++k) {
        const Tangent product = 2.0 * diagram.cells[k].mass * v[k] + -curvature.product(v, k, 1.0);
        result(static_cast<Eigen::Index>(2 * k), column) = product.u;
        result(static_cast<Eigen::Index>(2 * k + 1), column) = product.v;
      }
    }
    return result;
  }

  /// The same by central differences of the gradient.
  [[nodiscard]] Eigen::MatrixXd differences(double step) const {
    const auto size = static_cast<Eigen::Index>(2 * kCount);
    Eigen::MatrixXd result(size, size);
    for (Eigen::Index column = 0; column < size; ++column) {
      const auto gradient = [&](double way) {
        Sites moved = sites;
        moved.barycentric.clear();
        moved.positions[static_cast<std::size_t>(column / 2)] += way * bases[0].col(column % 2);
        const SurfaceDomain domain(surface, Cells::kEuclidean);
        const Sites there = domain.project(moved.positions, moved.faces);
        return evaluate_energy(domain, there, 0.0).gradient;
      };
      const std::vector<Vec3> after = gradient(step), before = gradient(-step);
      for (std::size_t k = 0; k < kCount; ++k)
        result.block<2, 1>(static_cast<Eigen::Index>(2 * k), column) =
            bases[0].transpose() * (after[k] - before[k]) / (2.0 * step);
    }
    return result;
  }

  Surface surface;
  Sites sites;
  RestrictedVoronoi diagram;
  std::vector<TangentBasis> bases;
  BoundaryCurvature curvature;
};

TEST(BoundaryCurvature, MakesTheHessianOfTheEnergy) {
  for (const double density : {1.0, 3.0}) {
    const Fixture f(density);
    const Eigen::MatrixXd found = f.hessian(), wanted = f.differences(1e-5);
    EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), 1e-4 * wanted.cwiseAbs().maxCoeff())
        << "density " << density;
  }
}

TEST(BoundaryCurvature, IsPositiveSemidefinite) {
  const Fixture f;
  Eigen::MatrixXd b = -f.hessian();
  for (std::size_t k = 0; k < kCount; ++k)
    b.diagonal().segment<2>(static_cast<Eigen::Index>(2 * k)).array() +=
        2.0 * f.diagram.cells[k].mass;
  EXPECT_LT((b - b.transpose()).cwiseAbs().maxCoeff(), 1e-12 * b.cwiseAbs().maxCoeff());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(b).eigenvalues()[0],
            -1e-12 * b.cwiseAbs().maxCoeff());
}

TEST(BoundaryCurvature, HasTheBlocksOfItsDiagonal) {
  const Fixture f;
  const Eigen::MatrixXd hessian = f.hessian();
  for (std::size_t k = 0; k < kCount; ++k) {
    const auto at = static_cast<Eigen::Index>(2 * k);
    const TangentBlock block = f.curvature.block(k);
    const double mass = 2.0 * f.diagram.cells[k].mass;
    EXPECT_NEAR(block.uu, mass - hessian(at, at), 1e-12);
    EXPECT_NEAR(block.uv, -hessian(at, at + 1), 1e-12);
    EXPECT_NEAR(block.vv, mass - hessian(at + 1, at + 1), 1e-12);
  }
}

TEST(BoundaryCurvature, OfSomeSitesRefersToThese) {
  const Fixture f;
  std::vector<std::int32_t> members(kCount);  // every second of twice as many
  for (std::size_t k = 0; k < kCount; ++k) members[k] = static_cast<std::int32_t>(2 * k + 1);
  const std::vector<TangentBasis> bases(2 * kCount, f.bases[0]);
  BoundaryCurvature some;
  some.update(f.diagram, members, bases, 1.0);
  ASSERT_EQ(some.cells(), kCount);
  TangentVectors v(kCount), all(2 * kCount, {9.0, 9.0});
  for (std::size_t k = 0; k < kCount; ++k)
    all[some.site(k)] = v[k] = {0.1 * static_cast<double>(k % 7), 0.3 * static_cast<double>(k % 3)};
  for (std::size_t k = 0; k < kCount; ++k) {
    EXPECT_EQ(some.product(all, k, 0.5).u, f.curvature.product(v, k, 0.5).u);
    EXPECT_EQ(some.product(all, k, 0.5).v, f.curvature.product(v, k, 0.5).v);
  }
}

TEST(BoundaryCurvature, LeavesOutBoundariesWithoutExtent) {
  Fixture f;
  for (CellBoundary& boundary : f.diagram.boundaries) boundary.flux = Vec3::Zero();
  f.curvature.update(f.diagram, {}, f.bases, 1.0);
  EXPECT_EQ(f.curvature.product(TangentVectors(kCount, {1.0, 1.0}), 0, 1.0).u, 0.0);
  f.curvature.clear();
  EXPECT_TRUE(f.curvature.empty());
}

}  // namespace
}  // namespace dapple::test
