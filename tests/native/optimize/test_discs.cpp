// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "optimize/discs.hpp"

namespace dapple::test {
namespace {

/// Two discs at a distance of 0.9 times the sum of their radii.
TEST(Discs, OfDifferentSizePushEachOtherApart) {
  const Sites sites{{{0, 0, 0}, {0.9, 0, 0}, {5, 0, 0}}, {0, 0, 0}, {}};
  const Vectors normals(3, Vec3::UnitZ());
  const std::vector<double> radii{0.7, 0.3, 0.1};
  const Repulsion repulsion = evaluate_disc_repulsion({sites, normals, radii}, 2.0);
  ASSERT_EQ(repulsion.pairs.size(), 1u);
  EXPECT_NEAR(repulsion.energy, 2.0 * 0.01, 1e-12);
  EXPECT_NEAR(worst_pair(repulsion)->overlap, 0.1, 1e-12);
  // descent moves it away from the other
  EXPECT_LT(repulsion.gradient[0].dot(Vec3(-1, 0, 0)), 0.0);
}

TEST(Discs, KeepOutPointsThatDoNotMeetEachOther) {
  const Sites sites{{{0, 0, 0}, {0.3, 0, 0}, {0.31, 0, 0}, {0.5, 0, 0}}, {0, 0, 0, 0}, {}};
  const Vectors normals(4, Vec3::UnitZ());
  const std::vector<double> radii{0.4, 0.0, 0.0, 0.0};
  const Repulsion repulsion = evaluate_disc_repulsion({sites, normals, radii}, 1.0);
  ASSERT_EQ(repulsion.pairs.size(), 2u);
  EXPECT_NEAR(worst_pair(repulsion)->overlap, 0.25, 1e-12);
  for (const ClosePair& pair : repulsion.pairs) EXPECT_EQ(std::min(pair.i, pair.j), 0);
}

TEST(Discs, OverlapWhereTheyCoincide) {
  const Sites sites{{{1, 2, 3}, {1, 2, 3}}, {0, 0}, {}};
  const Vectors normals(2, Vec3::UnitZ());
  const std::vector<double> radii{0.4, 0.0};
  const Repulsion repulsion = evaluate_disc_repulsion({sites, normals, radii}, 1.0);
  ASSERT_EQ(repulsion.pairs.size(), 1u);
  EXPECT_NEAR(repulsion.pairs[0].overlap, 1.0, 1e-6);
  Vectors moves(2, Vec3::Zero());
  keep_discs_apart({sites, normals, radii}, {}, moves);
  EXPECT_GT((moves[0] - moves[1]).norm(), 0.399);
}

TEST(Discs, ThatCoincideOnAFaceWithoutAreaComeApartToo) {
  const Sites sites{{{1, 2, 3}, {1, 2, 3}}, {0, 0}, {}};
  const Vectors normals(2, Vec3::Zero());
  const std::vector<double> radii(2, 0.4);
  const Repulsion repulsion = evaluate_disc_repulsion({sites, normals, radii}, 1.0);
  ASSERT_EQ(repulsion.pairs.size(), 1u);
  EXPECT_NEAR(repulsion.energy, 1.0, 1e-6);
  EXPECT_TRUE(repulsion.gradient[0].allFinite());
}

TEST(Discs, OnTheTwoSidesOfAWallDoNotMeet) {
  const Sites sites{{{0, 0, 0}, {0, 0, 0.1}}, {0, 0}, {}};
  const Vectors normals{Vec3::UnitZ(), -Vec3::UnitZ()};
  const std::vector<double> radii(2, 1.0);
  EXPECT_TRUE(evaluate_disc_repulsion({sites, normals, radii}, 1.0).pairs.empty());
}

TEST(Discs, MeetAcrossTheSeamOfTheTorus) {
  const Sites sites{{{0.02, 0.5, 0}, {2.97, 0.5, 0}}, {0, 0}, {}};
  const Vectors normals(2, Vec3::UnitZ());
  const std::vector<double> radii(2, 0.05);
  const Repulsion repulsion = evaluate_disc_repulsion({sites, normals, radii, 1.0}, 1.0);
  ASSERT_EQ(repulsion.pairs.size(), 1u);
  EXPECT_NEAR(repulsion.pairs[0].overlap, 0.5, 1e-9);
  EXPECT_NEAR(repulsion.pairs[0].direction.x() * (repulsion.pairs[0].i == 0 ? 1.0 : -1.0), 1.0,
              1e-9);
}

/// A row of discs of radius 0.5 along x in the plane.
struct Row {
  explicit Row(const std::vector<double>& along) : normals(along.size(), Vec3::UnitZ()) {
    for (const double x : along) sites.positions.emplace_back(x, 0.0, 0.0);
    sites.faces.assign(along.size(), 0);
    radii.assign(along.size(), 0.5);
    moves.assign(along.size(), Vec3::Zero());
  }

  void keep_apart(const std::vector<bool>& locked = {}) {
    keep_discs_apart({sites, normals, radii}, locked, moves);
  }

  [[nodiscard]] double after(std::size_t k) const { return (sites.positions[k] + moves[k]).x(); }

  Sites sites;
  Vectors normals, moves;
  std::vector<double> radii;
};

TEST(DiscsKeptApart, TouchWhereTheirMovesWouldBringThemNearer) {
  Row row({0.0, 1.5});
  row.moves = {Vec3(0.4, 0.3, 0.0), Vec3(-0.4, 0.0, 0.0)};
  row.keep_apart();
  EXPECT_NEAR(row.after(1) - row.after(0), 1.0, 1e-3);
  EXPECT_NEAR(row.after(0), 0.25, 1e-3);  // both discs move by the same distance
  EXPECT_EQ(row.moves[0].y(), 0.3);       // tangential motion is not restricted
}

TEST(DiscsKeptApart, PushPointsOut) {
  Row row({0.0, 0.3});
  row.radii[1] = 0.0;
  row.keep_apart();
  EXPECT_GE(row.after(1) - row.after(0), 0.5);
}

TEST(DiscsKeptApart, KeepMovesThatBringNoneTooNear) {
  Row row({0.0, 1.5, 4.0});
  row.moves = {Vec3(0.2, 0.1, 0.0), Vec3(-0.2, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0)};
  const Vectors before = row.moves;
  row.keep_apart();
  EXPECT_EQ(row.moves, before);
}

TEST(DiscsKeptApart, GiveWayToLockedOnesAlone) {
  Row row({0.0, 0.8});
  row.keep_apart({true, false});
  EXPECT_EQ(row.moves[0], Vec3::Zero());
  EXPECT_NEAR(row.after(1), 1.0, 1e-3);
}

TEST(DiscsKeptApart, PassAPushOn) {
  Row row({0.0, 0.7, 1.75});
  row.keep_apart({true, false, false});
  EXPECT_NEAR(row.after(1), 1.0, 2e-3);
  EXPECT_NEAR(row.after(2), 2.0, 2e-3);
}

TEST(DiscsKeptApart, StayInTheirPlanes) {
  Row row({0.0, 0.5});
  row.sites.positions[1].z() = 0.3;
  row.keep_apart();
  EXPECT_EQ(row.moves[0].z(), 0.0);
  EXPECT_LT(row.moves[0].x(), 0.0);
  EXPECT_GT(row.moves[1].x(), 0.0);
}

}  // namespace
}  // namespace dapple::test
