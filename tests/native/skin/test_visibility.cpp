// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/visibility.hpp>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Eye = std::array<double, 4>;

TEST(Visibility, OfABallIsTheSideThatFacesTheEye) {
  const Shape ball = icosphere(3);
  const Surface surface = ball.surface();
  std::vector<Vec3> points;
  for (const Vec3& p : surface.vertices()) points.push_back(p);
  const auto seen = seen_from(surface, Eye{3.0, 0.013, 0.021, 1.0}, points);
  const auto far = seen_from(surface, Eye{1.0, 0.013, 0.021, 0.0}, points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double x = points[k].x();
    if (std::abs(x - 1.0 / 3.0) > 0.15) {
      EXPECT_EQ(seen[k] == 1, x > 1.0 / 3.0);
    }
    if (std::abs(x) > 0.15) {
      EXPECT_EQ(far[k] == 1, x > 0.0);
    }
  }
}

TEST(Visibility, EndsAtTheEye) {
  const Surface sheet = grid(2).surface();  // the unit square at z = 0
  const std::vector<Vec3> points = {{0.3, 0.4, -1.0}, {0.3, 0.4, 1.0}, {0.3, 0.4, 0.0}};
  const std::vector<std::uint8_t> above = {0, 1, 1}, between = {1, 0, 1};
  EXPECT_EQ(seen_from(sheet, Eye{0.3, 0.4, 2.0, 1.0}, points), above);
  EXPECT_EQ(seen_from(sheet, Eye{0.3, 0.4, -0.5, 1.0}, points), between);
  EXPECT_TRUE(seen_from(sheet, Eye{0.0, 0.0, 1.0, 0.0}, {}).empty());
}

TEST(Visibility, OfAPointAtTheEyeIsClear) {
  const std::vector<Vec3> points = {{0.3, 0.4, 2.0}};
  EXPECT_EQ(seen_from(grid(2).surface(), Eye{0.3, 0.4, 2.0, 1.0}, points)[0], 1);
}

TEST(Visibility, NamesWhatIsWrong) {
  const Surface surface = grid(1).surface();
  const std::vector<Vec3> points = {Vec3::Zero(), {0.0, std::nan(""), 0.0}};
  const std::span<const Vec3> good(points.data(), 1);
  const auto refused = [&](const Eye& eye, std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>([&] { (void)seen_from(surface, eye, good); }, parts);
  };
  refused({0.0, std::nan(""), 0.0, 1.0}, {"eye[1]", "not finite"});
  refused({0.0, 1.0, 0.0, 0.5}, {"eye[3] is 0.5"});
  refused({0.0, 0.0, 0.0, 0.0}, {"direction without a length"});
  expect_message<ArgumentError>([&] { (void)seen_from(surface, {0, 0, 1, 1}, points); },
                                {"points[1]"});
}

}  // namespace
}  // namespace dapple::test
