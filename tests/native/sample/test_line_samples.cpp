// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/line_samples.hpp>
#include <numbers>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

/// Coordinates of a point of the unit cube that lie in its sides: 2 on an edge, 3 at a corner.
int sides_of(const Vec3& p) {
  int sides = 0;
  for (int k = 0; k < 3; ++k)
    if (std::min(std::abs(p[k]), std::abs(p[k] - 1.0)) < 1e-12) ++sides;
  return sides;
}

class LineShapes : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(All, LineShapes, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(LineShapes, GetExactlyAsManySamplesOrNone) {
  const Surface surface = GetParam().surface();
  for (const std::size_t count : {1u, 7u, 100u}) try {
      const LineSamples found = sample_lines(surface, count);
      ASSERT_EQ(found.samples.size(), count);
      ASSERT_EQ(found.tangents.size(), count);
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_NEAR(found.tangents[k].norm(), 1.0, 1e-9);
        EXPECT_NEAR(found.samples.normals[k].norm(), 1.0, 1e-9);
        EXPECT_NEAR(found.samples.barycentric[k].minCoeff(), 0.0, 1e-12);
        ASSERT_GE(found.lines[k], 0);
        ASSERT_LT(found.lines[k], static_cast<std::int32_t>(found.lengths.size()));
      }
    } catch (const ArgumentError&) {  // it has no lines, or no density on them
    }
}

TEST(SampleLines, AreEvenAlongTheEdgesOfACube) {
  const LineSamples found = sample_lines(box(4).surface(), 120);
  ASSERT_EQ(found.lengths.size(), 12u);
  std::vector<std::size_t> numbers(12, 0);
  for (std::size_t k = 0; k < 120; ++k) {
    EXPECT_EQ(sides_of(found.samples.positions[k]), 2);
    ++numbers[static_cast<std::size_t>(found.lines[k])];
    if (k == 0 || found.lines[k] != found.lines[k - 1]) continue;
    EXPECT_NEAR((found.samples.positions[k] - found.samples.positions[k - 1]).norm(), 0.1, 1e-12);
  }
  EXPECT_EQ(numbers, std::vector<std::size_t>(12, 10));
  EXPECT_NEAR(found.samples.report.spacing, 0.1, 1e-12);
}

TEST(SampleLines, StandAtCornersIfAsked) {
  LineOptions options;
  options.corners = true;
  const LineSamples found = sample_lines(box(4).surface(), 8 + 12 * 3, options);
  for (std::size_t k = 0; k < found.samples.size(); ++k)
    EXPECT_EQ(sides_of(found.samples.positions[k]), k < 8 ? 3 : 2);
  EXPECT_EQ(std::ranges::count(found.lines, -1), 8);
  EXPECT_NEAR((found.samples.positions[8] - found.samples.positions[9]).norm(), 0.25, 1e-12);
}

TEST(SampleLines, NormalsHalveTheAngleOfACrease) {
  const LineSamples found = sample_lines(box(2).surface(), 12);
  for (std::size_t k = 0; k < 12; ++k) {
    const Vec3 out = found.samples.positions[k] - Vec3::Constant(0.5);
    const Vec3 across = out - out.dot(found.tangents[k]) * found.tangents[k];
    EXPECT_NEAR(found.samples.normals[k].dot(across.normalized()), 1.0, 1e-9);
  }
}

TEST(SampleLines, FollowTheDensity) {
  const Shape shape = with_density(grid(8), [](const Vec3& p) { return p[0]; });
  const LineSamples found = sample_lines(shape.surface(), 2000);
  // Of the border's integral 0 + 1 + 1/2 + 1/2, the parts with x < 0.5 have 1/8 twice.
  const auto left =
      std::ranges::count_if(found.samples.positions, [](const Vec3& p) { return p[0] < 0.5; });
  EXPECT_NEAR(static_cast<double>(left), 2000.0 / 8.0, 2.0);
}

TEST(SampleLines, NaturalOnesKeepHalfTheDistance) {
  LineOptions options;
  options.line_spacing = LineSpacing::kNatural;
  const LineSamples found = sample_lines(tube(64, 8).surface(), 400, options);
  double least = 1.0, most = 0.0;
  for (std::size_t k = 1; k < 400; ++k) {
    if (found.lines[k] != found.lines[k - 1]) continue;
    const double apart = (found.samples.positions[k] - found.samples.positions[k - 1]).norm();
    least = std::min(least, apart / found.samples.report.spacing);
    most = std::max(most, apart / found.samples.report.spacing);
  }
  EXPECT_GT(least, 0.49);
  EXPECT_LT(least, 0.7);
  EXPECT_GT(most, 1.3);
  EXPECT_LT(most, 1.51);
}

TEST(SampleLines, FollowMarkedEdgesAlone) {
  LineOptions options;
  options.borders = false;
  for (std::int32_t k = 0; k < 4; ++k) options.edges.push_back({5 * k + 2, 5 * k + 7});
  const Shape shape = grid(4);  // 5 x 5 vertices, row after row
  const LineSamples found = sample_lines(shape.surface(), 10, options);
  ASSERT_EQ(found.lengths.size(), 1u);
  EXPECT_NEAR(found.lengths[0], 1.0, 1e-12);
  for (const Vec3& p : found.samples.positions)
    EXPECT_NEAR((p - shape.vertices[2]).cross(shape.vertices[22] - shape.vertices[2]).norm(), 0.0,
                1e-12);
}

TEST(SampleLines, DivideTheNumberByLength) {
  const Shape strip = mapped(grid(10), [](const Vec3& p) { return Vec3(3.0 * p[0], p[1], 0.0); });
  const LineSamples found = sample_lines(strip.surface(), 80);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(std::ranges::count(found.lines, static_cast<std::int32_t>(k)),
              found.lengths[k] > 2.0 ? 30 : 10);
}

/// Corners and lines of a shape.
std::array<std::size_t, 2> corners_and_lines(const Shape& shape) {
  const LineSamples found = sample_lines(shape.surface(), 100, {.corners = true});
  const auto corners = std::ranges::count(found.lines, -1);
  return {static_cast<std::size_t>(corners), found.lengths.size()};
}

/// A flat polygon with its corners on a circle.
Shape polygon(int corners) {
  Shape shape;
  shape.name = "polygon";
  for (int k = 0; k < corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / corners;
    shape.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    if (k > 1) shape.faces.push_back({0, k - 1, k});
  }
  return shape;
}

TEST(SampleLines, FindEveryLineOfABodyOfFewFaces) {
  using Found = std::array<std::size_t, 2>;
  const auto scaled = [](const Shape& shape, double x, double y, double z) {
    return mapped(shape, [=](const Vec3& p) { return Vec3(x * p[0], y * p[1], z * p[2]); });
  };
  EXPECT_EQ(corners_and_lines(grid(1)), (Found{4, 4}));
  EXPECT_EQ(corners_and_lines(scaled(grid(1), 100.0, 1.0, 1.0)), (Found{4, 4}));
  for (const auto& [x, y, z] : {std::array{1.0, 1.0, 1.0}, std::array{10.0, 1.0, 1.0},
                                std::array{100.0, 1.0, 1.0}, std::array{10.0, 10.0, 0.1}})
    EXPECT_EQ(corners_and_lines(scaled(box(1), x, y, z)), (Found{8, 12})) << x << ' ' << z;
  EXPECT_EQ(corners_and_lines(polygon(6)), (Found{6, 6}));
  EXPECT_EQ(corners_and_lines(polygon(8)), (Found{0, 1}));  // each turn is of 45 degrees, not more
}

TEST(SampleLines, SayWhatIsWrong) {
  const auto refused = [](const Shape& shape, std::size_t count, const LineOptions& options,
                          const std::string& words) {
    expect_message<ArgumentError>(
        [&] { std::ignore = sample_lines(shape.surface(), count, options); }, {words});
  };
  refused(box(2), 0, {}, "count is 0: it must be >= 1");
  refused(box(2), 7, {.corners = true}, "count is 7: there are 8 corners");
  refused(icosphere(3), 5, {}, "surface has no lines");
  refused(box(2), 5, {.feature_angle = 181.0}, "feature_angle is 181");
  refused(box(2), 5, {.edges = {{0, 99}}}, "edges[0] is (0, 99): no face has this edge");
  const auto nowhere = [](const Vec3& p) { return sides_of(p) < 2 ? 1.0 : 0.0; };
  refused(with_density(box(4), nowhere), 5, {}, "density is 0 along all lines");
}

TEST(SampleLines, StopWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW(std::ignore = sample_lines(box(2).surface(), 40, {}, &context), Cancelled);
}

}  // namespace
}  // namespace dapple::test
