// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/texture.hpp>
#include <limits>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

/// Texture coordinates equal to x and y of the vertices.
std::vector<FaceUv> seen_from_above(const Shape& shape) {
  std::vector<FaceUv> result;
  for (const Face& face : shape.faces) {
    FaceUv& uv = result.emplace_back();
    for (std::size_t c = 0; c < 3; ++c)
      uv[c] = shape.vertices[static_cast<std::size_t>(face[c])].head<2>();
  }
  return result;
}

TEST(Texture, FindsTheFaceUnderEachTexel) {
  const Shape shape = grid(7);
  const Surface surface = shape.surface();
  const Texels found = texels(surface, seen_from_above(shape), 20, 30, 0);
  ASSERT_EQ(found.size(), 600u);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec3 middle((static_cast<double>(k % 30) + 0.5) / 30.0,
                      (static_cast<double>(k / 30) + 0.5) / 20.0, 0.0);
    ASSERT_GE(found.faces[k], 0) << "no texel falls between two faces";
    EXPECT_NEAR((surface.point(found.faces[k], found.barycentric[k]) - middle).norm(), 0.0, 1e-12);
    EXPECT_GE(found.barycentric[k].minCoeff(), -1e-9);
  }
}

TEST(Texture, ContinuesFacesIntoTheMarginAndNoFarther) {
  const Shape shape = mapped(grid(1), [](const Vec3& p) { return Vec3(0.25 + 0.5 * p.array()); });
  const Surface surface = shape.surface();
  const std::vector<FaceUv> uv = seen_from_above(shape);
  const auto covered = [&](int margin) {
    const Texels found = texels(surface, uv, 40, 40, margin);
    return std::count_if(found.faces.begin(), found.faces.end(), [](int f) { return f >= 0; });
  };
  EXPECT_EQ(covered(0), 20 * 20);
  EXPECT_EQ(covered(1), 20 * 20 + 4 * 20);
  EXPECT_EQ(covered(2), 20 * 20 + 8 * 20 + 4);
  const Texels found = texels(surface, uv, 40, 40, 2);
  const Vec3 outside = surface.point(found.faces[20 * 40 + 8], found.barycentric[20 * 40 + 8]);
  EXPECT_NEAR(outside.x(), 8.5 / 40.0, 1e-12) << "in the plane of the face that it continues";
  EXPECT_NEAR(outside.y(), 20.5 / 40.0, 1e-12);
}

TEST(Texture, GivesOverlapsToTheLowestFaceAndLeavesOutWhatIsOutside) {
  const Shape sheets = two_sheets(2, 0.1);
  const Texels both = texels(sheets.surface(), seen_from_above(sheets), 16, 16, 0);
  const Texels one = texels(grid(2).surface(), seen_from_above(grid(2)), 16, 16, 0);
  EXPECT_EQ(both.faces, one.faces);
  const Shape far = mapped(grid(2), [](const Vec3& p) { return Vec3(p + Vec3(5.0, -3.0, 0.0)); });
  const Texels none = texels(far.surface(), seen_from_above(far), 16, 16);
  EXPECT_EQ(std::count(none.faces.begin(), none.faces.end(), -1), 256);
}

TEST(Texture, HandlesFacesWithoutAreaInTheImage) {
  const Shape shape = box(2);
  const Texels found = texels(shape.surface(), seen_from_above(shape), 16, 16);
  EXPECT_EQ(std::count(found.faces.begin(), found.faces.end(), -1), 0);
}

TEST(Texture, NamesWhatIsWrong) {
  const Shape shape = grid(1);
  const Surface surface = shape.surface();
  std::vector<FaceUv> uv = seen_from_above(shape);
  const auto run = [&](std::size_t rows, std::size_t columns, int margin) {
    return [&, rows, columns, margin] { (void)texels(surface, uv, rows, columns, margin); };
  };
  expect_message<ArgumentError>(run(0, 4, 0), {"rows is 0"});
  expect_message<ArgumentError>(run(4, 0, 0), {"columns is 0"});
  expect_message<ArgumentError>(run(4, 4, -1), {"margin", "-1"});
  uv[1][2].y() = std::numeric_limits<double>::infinity();
  expect_message<ArgumentError>(run(4, 4, 0), {"uv[1, 2]", "inf"});
  uv.pop_back();
  expect_message<ArgumentError>(run(4, 4, 0), {"uv has 1", "faces has 2"});
}

}  // namespace
}  // namespace dapple::test
