// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "shapes.hpp"
#include "voronoi/cell_polyhedron.hpp"

namespace dapple::test {
namespace {

const Eigen::AlignedBox3d kBox(Vec3(-1, -1, -1), Vec3(1, 1, 1));

std::vector<Vec3> vertices_of(CellPolyhedron& cell) {
  std::vector<Vec3> result;
  while (const std::optional<Vec3> vertex = cell.next_vertex()) result.push_back(*vertex);
  return result;
}

TEST(CellPolyhedron, IsABoxAtFirst) {
  CellPolyhedron cell;
  cell.start(kBox);
  const std::vector<Vec3> corners = vertices_of(cell);
  ASSERT_EQ(corners.size(), 8u);
  for (const Vec3& x : corners) EXPECT_NEAR((x.cwiseAbs() - Vec3::Ones()).norm(), 0.0, 1e-10);
}

TEST(CellPolyhedron, LosesACorner) {
  CellPolyhedron cell;
  cell.start(kBox);
  vertices_of(cell);
  ASSERT_TRUE(cell.is_cut_by(Vec3(1, 1, 1), 2.0));
  ASSERT_TRUE(cell.cut(Vec3(1, 1, 1), 2.0));
  const std::vector<Vec3> fresh = vertices_of(cell);
  ASSERT_EQ(fresh.size(), 3u);
  for (const Vec3& x : fresh) EXPECT_NEAR(x.sum(), 2.0, 1e-10);
  EXPECT_FALSE(cell.is_cut_by(Vec3(1, 1, 1), 2.0));
  EXPECT_TRUE(cell.touches(Vec3(1, 1, 1), 2.0));
  EXPECT_FALSE(cell.touches(Vec3(1, 1, 1), 2.5));
}

/// A plane through a vertex or along an edge or face neither fails nor takes anything away.
TEST(CellPolyhedron, IsTouchedWithoutLoss) {
  CellPolyhedron cell;
  cell.start(kBox);
  vertices_of(cell);
  for (const Vec3& normal : {Vec3(1, 1, 1), Vec3(1, 1, 0), Vec3(1, 0, 0)}) {
    EXPECT_FALSE(cell.is_cut_by(normal, normal.sum()));
    EXPECT_TRUE(cell.touches(normal, normal.sum()));
    EXPECT_TRUE(cell.cut(normal, normal.sum()));
  }
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner = kBox.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
    EXPECT_TRUE(cell.touches(corner, corner.squaredNorm()));
  }
}

/// What counts is the plane, not how long its normal is.
TEST(CellPolyhedron, AnswersTheSameForNormalsOfAnyLength) {
  CellPolyhedron cell;
  cell.start(kBox);
  vertices_of(cell);
  const Vec3 normal(1, 1, 1);
  for (const double length : {1e-9, 1e-3, 1.0, 1e3, 1e9}) {
    EXPECT_FALSE(cell.is_cut_by(length * normal, length * 3.0)) << length;
    EXPECT_TRUE(cell.is_cut_by(length * normal, length * 2.999)) << length;
    EXPECT_TRUE(cell.touches(length * normal, length * 3.0)) << length;
    EXPECT_FALSE(cell.touches(length * normal, length * 3.001)) << length;
    CellPolyhedron less = cell;
    EXPECT_TRUE(less.cut(length * normal, length * 2.999)) << length;
    EXPECT_EQ(vertices_of(less).size(), 3u) << length;
  }
}

TEST(CellPolyhedron, AnswersTheSameForBoxesOfAnySize) {
  const Vec3 normal(1, 1, 1);
  for (const double size : {1e-9, 1e-3, 1.0, 1e3, 1e9}) {
    CellPolyhedron cell;
    cell.start({size * kBox.min(), size * kBox.max()});
    EXPECT_FALSE(cell.is_cut_by(normal, size * 3.0)) << size;
    EXPECT_TRUE(cell.is_cut_by(normal, size * 2.999)) << size;
    EXPECT_TRUE(cell.touches(normal, size * 3.0)) << size;
    EXPECT_FALSE(cell.touches(normal, size * 3.001)) << size;
  }
}

Vec3 on_lattice(Random& random) {
  return Vec3(random.below(5) - 2, random.below(5) - 2, random.below(5) - 2);
}

/// What is nearer to the middle than to any of the others never leaves it, nor does more stay; on a
/// lattice many planes meet in one vertex.
TEST(CellPolyhedron, HoldsTheVoronoiCell) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    std::vector<Vec3> others;
    for (int k = 0; k < 60; ++k)
      others.push_back(round % 2 == 0 ? on_lattice(random) : random.in_box());
    std::erase_if(others, [](const Vec3& x) { return x.squaredNorm() == 0.0; });
    CellPolyhedron cell;
    cell.start(kBox);
    for (const Vec3& x : others) {
      if (!cell.is_cut_by(x, 0.5 * x.squaredNorm())) continue;
      ASSERT_TRUE(cell.cut(x, 0.5 * x.squaredNorm()));
    }
    for (int k = 0; k < 200; ++k) {
      const Vec3 x = random.in_box();
      const auto nearer = [&](const Vec3& o) { return (x - o).squaredNorm() < x.squaredNorm(); };
      if (std::none_of(others.begin(), others.end(), nearer)) {
        EXPECT_TRUE(cell.touches(x, x.squaredNorm()));
      }
    }
    for (const Vec3& x : vertices_of(cell))
      for (const Vec3& o : others) EXPECT_LT(x.squaredNorm(), (x - o).squaredNorm() + 1e-9);
  }
}

}  // namespace
}  // namespace dapple::test
