// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <sstream>

#include "base/random.hpp"
#include "surface/cut_polygon.hpp"
#include "surface/mesh_readers.hpp"

namespace dapple::test {
namespace {

using Polygon = std::vector<Vec3>;

/// A floor with a notch of 1 by 2, seen from above.
const Polygon kFloor = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0},
                        {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};

int below(Random& random, int count) { return static_cast<int>(count * random.uniform()); }

double area(const Polygon& corners) {
  double sum = 0.0;
  for (const auto& [a, b, c] : cut_polygon(corners)) {
    const Vec3& p = corners[static_cast<std::size_t>(a)];
    sum += 0.5 * (corners[static_cast<std::size_t>(b)] - p)
                     .cross(corners[static_cast<std::size_t>(c)] - p)
                     .norm();
  }
  return sum;
}

Polygon turned(Polygon corners, const Eigen::AngleAxisd& turn, const Vec3& shift) {
  for (Vec3& p : corners) p = turn * p + shift;
  return corners;
}

Polygon begun_at(Polygon corners, std::ptrdiff_t first) {
  std::rotate(corners.begin(), corners.begin() + first, corners.end());
  return corners;
}

TEST(CutPolygon, AFloorWithANotchHasNothingInTheNotch) {
  for (std::ptrdiff_t first = 0; first < 8; ++first)
    for (const bool back : {false, true}) {
      Polygon floor = begun_at(kFloor, first);
      if (back) std::reverse(floor.begin(), floor.end());
      const auto cuts = cut_polygon(floor);
      EXPECT_EQ(cuts.size(), 6u);
      EXPECT_DOUBLE_EQ(area(floor), 7.0);
      for (const auto& [a, b, c] : cuts) {
        const Vec3 &p = floor[static_cast<std::size_t>(a)], &q = floor[static_cast<std::size_t>(b)],
                   &r = floor[static_cast<std::size_t>(c)];
        EXPECT_GT((q - p).cross(r - p).z() * (back ? -1.0 : 1.0), 0.0);
        const Vec3 middle = (p + q + r) / 3.0;
        EXPECT_FALSE(middle.x() > 1 && middle.x() < 2 && middle.y() > 1) << middle.transpose();
      }
    }
}

TEST(CutPolygon, AnywhereInSpace) {
  const Eigen::AngleAxisd turn(1.1, Vec3(1, -2, 0.5).normalized());
  EXPECT_NEAR(area(turned(kFloor, turn, {10, 20, -5})), 7.0, 1e-12);
  EXPECT_NEAR(area(turned(kFloor, turn, {1e6, 0, 1e6})), 7.0, 1e-6);
  for (const double scale : {1e-70, 1e-9, 1e9, 1e70}) {
    Polygon floor = kFloor;
    for (Vec3& p : floor) p *= scale;
    EXPECT_EQ(cut_polygon(floor).size(), 6u) << scale;
    EXPECT_NEAR(area(floor) / scale / scale, 7.0, 1e-12) << scale;
  }
}

TEST(CutPolygon, ConvexOnesAreFans) {
  Polygon round;
  for (int k = 0; k < 9; ++k)
    round.emplace_back(std::cos(k * 2 * std::numbers::pi / 9),
                       std::sin(k * 2 * std::numbers::pi / 9), 0.01 * (k % 2));
  const auto cuts = cut_polygon(round);
  ASSERT_EQ(cuts.size(), 7u);
  for (std::int32_t k = 0; k < 7; ++k)
    EXPECT_EQ(cuts[static_cast<std::size_t>(k)], (std::array<std::int32_t, 3>{0, k + 1, k + 2}));
}

TEST(CutPolygon, NearlyFlatOnesKeepTheirShape) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    Polygon floor = kFloor;
    for (Vec3& p : floor) p.z() = 0.1 * random.uniform();
    EXPECT_NEAR(area(begun_at(floor, round % 8)), 7.0, 0.2);
  }
}

/// Seen along an axis, two of its corners coincide.
TEST(CutPolygon, AQuadFarFromFlatKeepsItsCorners) {
  EXPECT_EQ(cut_polygon(Polygon{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}).size(), 2u);
}

TEST(CutPolygon, ADartIsCutThroughItsDent) {
  const Polygon dart = {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}};
  for (std::ptrdiff_t first = 0; first < 4; ++first)
    EXPECT_DOUBLE_EQ(area(begun_at(dart, first)), 1.0);
}

TEST(CutPolygon, HandlesCornersOnALine) {
  const Polygon square = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}};
  for (std::ptrdiff_t first = 0; first < 6; ++first) {
    EXPECT_DOUBLE_EQ(area(begun_at(square, first)), 4.0);
    EXPECT_EQ(cut_polygon(begun_at(square, first)).size(), 4u);
  }
  EXPECT_EQ(area({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), 0.0);
}

TEST(CutPolygon, HandlesRepeatedCorners) {
  EXPECT_DOUBLE_EQ(area({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}}), 1.0);
  EXPECT_DOUBLE_EQ(area({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}}), 0.5);
  EXPECT_EQ(area({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), 0.0);
}

/// Some programs write a face with a hole as one polygon that goes in and out along the same edge.
TEST(CutPolygon, AHoleAtTheEndOfABridgeStaysOne) {
  const Polygon ring = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                        {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
  for (std::ptrdiff_t first = 0; first < 10; ++first)
    EXPECT_DOUBLE_EQ(area(begun_at(ring, first)), 8.0);
}

TEST(CutPolygon, AnEdgeThatGoesOutAndBackAddsNothing) {
  EXPECT_DOUBLE_EQ(area({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 2, 0}, {1, 1, 0}, {0, 1, 0}}), 1.0);
}

TEST(CutPolygon, HandlesEdgesThatCross) {
  EXPECT_LE(area({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}), 1.0 + 1e-12);
  Polygon star;
  for (int k = 0; k < 5; ++k)
    star.emplace_back(std::cos(k * 4 * std::numbers::pi / 5),
                      std::sin(k * 4 * std::numbers::pi / 5), 0.0);
  EXPECT_EQ(cut_polygon(star).size(), 3u);
  Polygon slip = kFloor;  // one edge barely crosses another
  slip[4] = {1 - 1e-6, 1, 0};
  slip[5] = {1 + 1e-6, 1, 0};
  slip[3] = {1 + 1e-6, 3, 0};
  EXPECT_LE(area(slip), 9.1);
}

TEST(CutPolygon, APolygonTakenTwiceHasItsAreaAtMostTwice) {
  const Polygon twice = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_GE(area(twice), 0.5);
  EXPECT_LE(area(twice), 1.0 + 1e-12);
}

TEST(CutPolygon, UsesEveryCorner) {
  Random random(5);
  for (int round = 0; round < 2000; ++round) {
    Polygon corners;
    const int count = 3 + below(random, 12);
    for (int k = 0; k < count; ++k)  // few different positions, so that many edges intersect
      corners.emplace_back(below(random, 4), below(random, 4),
                           round % 3 == 0 ? below(random, 2) : 0);
    const auto cuts = cut_polygon(corners);
    EXPECT_LE(cuts.size(), static_cast<std::size_t>(count - 2));
    for (const auto& cut : cuts)
      for (const std::int32_t k : cut) EXPECT_TRUE(k >= 0 && k < count);
  }
}

TEST(CutPolygon, HandlesCoordinatesThatAreNotFinite) {
  Polygon floor = kFloor;
  floor[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cut_polygon(floor).size(), 6u);
  floor[3].x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cut_polygon(floor).size(), 6u);
  floor[3].x() = 1e308;
  EXPECT_EQ(cut_polygon(floor).size(), 6u);
}

TEST(CutPolygon, AThousandCorners) {
  Polygon comb;
  for (int k = 0; k < 250; ++k)
    for (const Vec3& p : {Vec3(k, 0, 0), Vec3(k, 1, 0), Vec3(k + 0.5, 1, 0), Vec3(k + 0.5, 0, 0)})
      comb.push_back(p);
  comb.emplace_back(249.5, -1, 0);
  comb.emplace_back(0, -1, 0);
  std::reverse(comb.begin(), comb.end());
  EXPECT_NEAR(area(comb), 249.5 + 250 * 0.5, 1e-9);
}

/// Texture coordinates and normals follow their corners in every format.
TEST(CutPolygon, KeepsAttributesOfCorners) {
  std::ostringstream obj, off, ply, face;
  off << "OFF\n8 1 0\n";
  ply << "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  face << "f";
  for (std::size_t k = 0; k < 8; ++k) {
    const double x = kFloor[k].x(), y = kFloor[k].y();
    obj << "v " << x << " " << y << " 0\nvt " << x << " " << y << "\nvn 0 0 " << k + 1 << "\n";
    off << x << " " << y << " 0\n";
    ply << x << " " << y << " 0\n";
    face << " " << k + 1 << "/" << k + 1 << "/" << k + 1;
  }
  const std::string corners = "8 0 1 2 3 4 5 6 7\n";
  const MeshArrays mesh = read_obj(obj.str() + face.str() + "\n");
  ASSERT_EQ(mesh.faces.size(), 6u);
  EXPECT_EQ(read_off(off.str() + corners).faces, mesh.faces);
  EXPECT_EQ(read_ply(ply.str() + corners).faces, mesh.faces);
  EXPECT_EQ(mesh.polygons, std::vector<std::int32_t>(6, 0));
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.faces[f][k]);
      EXPECT_EQ(mesh.uv[f][k], Vec2(kFloor[v].x(), kFloor[v].y()));
      EXPECT_EQ(mesh.normals[f][k].z(), static_cast<double>(v + 1));
    }
}

}  // namespace
}  // namespace dapple::test
