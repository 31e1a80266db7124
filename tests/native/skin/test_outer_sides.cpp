// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/exposure.hpp>
#include <dapple/sampler.hpp>

#include "shapes.hpp"
#include "skin/outer_sides.hpp"

namespace dapple::test {
namespace {

constexpr double kBrick = 0.4;  // width and height of the brick on the wall

Shape placed(const Shape& shape, const Vec3& size, const Vec3& from) {
  return mapped(shape, [&](const Vec3& p) { return Vec3(size.cwiseProduct(p) + from); });
}

Shape turned_over(Shape shape) {
  for (Face& face : shape.faces) std::swap(face[0], face[1]);
  return shape;
}

/// A box without the faces on one of its sides.
Shape open_box(int cells, Eigen::Index axis, double side) {
  Shape shape = box(cells);
  std::erase_if(shape.faces, [&](const Face& face) {
    return std::ranges::all_of(face, [&](std::int32_t v) {
      return shape.vertices[static_cast<std::size_t>(v)][axis] == side;
    });
  });
  return shape;
}

/// A hollow wall without a bottom, so that its inside is seen from below.
Shape wall() { return placed(open_box(8, 2, 0.0), {2.0, 0.5, 1.0}, Vec3::Zero()); }

/// The wall with a brick on its front, which has no back.
Shape wall_with_brick() {
  return joined(wall(), placed(open_box(2, 1, 1.0), {kBrick, 0.1, kBrick}, {0.83, -0.08, 0.07}));
}

/// Whether the center of a face lies on the wall behind the brick.
bool is_behind_brick(const Surface& surface, std::size_t face) {
  const Vec3 place = surface.point(static_cast<std::int32_t>(face), Vec3::Constant(1.0 / 3.0));
  return place.y() == 0.0 && std::abs(place.x() - 1.03) < 0.5 * kBrick &&
         std::abs(place.z() - 0.27) < 0.5 * kBrick;
}

TEST(OuterSides, TheInsideOfAnOpenBodyIsNone) {
  for (const Shape& shape : {wall_with_brick(), turned_over(wall_with_brick())}) {
    const Surface surface = shape.surface();
    const std::vector<double> found = exposure(surface);
    std::size_t behind = 0;
    for (std::size_t f = 0; f < found.size(); ++f) {
      if (!is_behind_brick(surface, f)) continue;
      ++behind;
      EXPECT_EQ(found[f], 0.0) << f;
    }
    EXPECT_GT(behind, 3U);
  }
}

TEST(OuterSides, AreToldFacesThatAreTurnedOverByTheirPatch) {
  Shape shape = wall_with_brick();
  const std::vector<double> before = exposure(shape.surface());
  for (std::size_t f = 0; f < shape.faces.size(); f += 7)
    std::swap(shape.faces[f][0], shape.faces[f][1]);
  const std::vector<double> after = exposure(shape.surface());
  for (std::size_t f = 0; f < after.size(); ++f)
    if (before[f] > 0.5) {
      EXPECT_NEAR(after[f], before[f], 0.05) << f;  // other directions are above the face
    }
}

TEST(OuterSides, AreBothOfALeaf) {
  // A box stands closely above it, so that it is seen from below there.
  const Shape leaf = grid(8);
  const Surface surface =
      joined(leaf, placed(box(2), Vec3::Constant(0.5), {0.2, 0.2, 0.01})).surface();
  const std::vector<double> found = exposure(surface);
  for (std::size_t f = 0; f < leaf.faces.size(); ++f) EXPECT_EQ(found[f], 1.0) << f;
}

TEST(OuterSides, AreThoseThatSeeTheMoreSky) {
  const Surface surface = box(1).surface();
  const auto of = [&](double front, double back) {
    return outer_sides(surface,
                       [=](const Vec3&, const Vec3&) { return std::array{front, back}; })[0];
  };
  EXPECT_EQ(of(0.9, 0.2), Sides::kFront);
  EXPECT_EQ(of(0.2, 0.9), Sides::kBack);
  EXPECT_EQ(of(0.9, 0.6), Sides::kBoth);
  EXPECT_EQ(of(0.05, 0.0), Sides::kBoth);  // too little to tell
}

/// A hollow box without a floor, and a small box that hangs in it at a height.
Surface with_lamp(double height) {
  const Shape lamp = placed(box(2), Vec3::Constant(0.2), {0.4, 0.4, height});
  return joined(open_box(8, 2, 0.0), lamp).surface();
}

TEST(OuterSides, LeaveOutWhatHangsHighInAHollowBody) {
  const Surface house = open_box(8, 2, 0.0).surface();
  const Surface surface = with_lamp(0.7);
  const std::vector<double> seen = exposure(surface);
  EXPECT_GT(
      *std::max_element(seen.begin() + static_cast<std::ptrdiff_t>(house.face_count()), seen.end()),
      0.1);
  const auto left = [&](double openness) {
    return refine_outside(surface, {.openness = openness, .edge = 0.05}).surface.capacity();
  };
  // Its lower side looks down through the floor.
  EXPECT_NEAR(left(0.05), house.area() + 0.04, 1e-9);
  EXPECT_GT(left(0.0), house.area() + 0.1);
}

TEST(OuterSides, KeepWhatHangsOutOfAHollowBody) {
  const Surface house = open_box(8, 2, 0.0).surface();
  const double left = refine_outside(with_lamp(-0.1), {.edge = 0.05}).surface.capacity();
  EXPECT_GT(left, house.area() + 0.04 + 4.0 * 0.2 * 0.1);
}

TEST(OuterSides, KeepSamplesEvenWhereBricksStandOutOfAnOpenWall) {
  const Surface surface = wall_with_brick().surface();
  constexpr std::size_t kCount = 300;
  const Refined refined = refine_outside(surface, {.edge = 0.1 * surface.spacing(kCount)});
  // The brick covers as much of the wall as it has front.
  const double sides = 4.0 * kBrick * 0.08;
  EXPECT_NEAR(refined.surface.capacity(), wall().surface().area() + sides, 0.01 * surface.area());
  const Report report = sample(refined.surface, kCount).report;
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.evenness.capacity_variation, 0.01);
  EXPECT_GT(report.evenness.alpha_min, 0.5);
}

}  // namespace
}  // namespace dapple::test
