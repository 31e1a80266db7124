// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/elementary.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kUlp = std::numeric_limits<double>::epsilon();

TEST(Elementary, DirectionsAreThoseOfTheCLibrary) {
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const double turns = random.between(-1.0, 1.0);
    const auto [cosine, sine] = direction(turns);
    EXPECT_NEAR(cosine, std::cos(2.0 * kPi * turns), 8 * kUlp) << turns;
    EXPECT_NEAR(sine, std::sin(2.0 * kPi * turns), 8 * kUlp) << turns;
  }
}

TEST(Elementary, WholeQuartersOfATurnAreExact) {
  for (int k = -9; k <= 9; ++k) {
    const auto [cosine, sine] = direction(0.25 * k);
    EXPECT_EQ(std::abs(cosine), k % 2 == 0 ? 1.0 : 0.0) << k;
    EXPECT_EQ(std::abs(sine), k % 2 == 0 ? 0.0 : 1.0) << k;
  }
  EXPECT_EQ(direction(0.25).sine, 1.0);
  EXPECT_EQ(direction(-0.25).sine, -1.0);
  EXPECT_EQ(direction(0.5).cosine, -1.0);
}

TEST(Elementary, AnglesAreThoseOfTheCLibrary) {
  Random random(2);
  for (int k = 0; k < 20000; ++k) {
    const double scale = std::ldexp(1.0, random.below(200) - 100);
    const double y = random.between(-1.0, 1.0) * scale, x = random.between(-1.0, 1.0);
    const double angle = std::atan2(y, x);
    EXPECT_NEAR(angle_of(y, x), angle, 4 * kUlp * std::abs(angle)) << y << ' ' << x;
  }
}

TEST(Elementary, AnglesSideBySideHaveTheSameBits) {
  Random random(5);
  std::vector<double> y = {0.0, -0.0, 0.0, -0.0, 2.0, -2.0, 0.0}, x = {0, 0, -3, -3, 0, 0, 3};
  while (y.size() < 1001) {
    y.push_back(random.between(-1.0, 1.0));
    x.push_back(random.between(-1.0, 1.0));
  }
  std::vector<double> angles(y.size());
  angles_of(y, x, angles);
  for (std::size_t k = 0; k < y.size(); ++k) {
    EXPECT_EQ(angles[k], angle_of(y[k], x[k])) << y[k] << ' ' << x[k];
    EXPECT_EQ(std::signbit(angles[k]), std::signbit(y[k])) << y[k] << ' ' << x[k];
  }
}

TEST(Elementary, AnglesOfTheAxesAreExact) {
  for (const double y : {0.0, -0.0})
    for (const double x : {0.0, 3.0}) EXPECT_EQ(angle_of(y, x), 0.0);
  EXPECT_EQ(angle_of(0.0, -3.0), kPi);
  EXPECT_EQ(angle_of(-0.0, -3.0), -kPi);
  EXPECT_EQ(angle_of(2.0, 0.0), 0.5 * kPi);
  EXPECT_EQ(angle_of(-2.0, 0.0), -0.5 * kPi);
}

TEST(Elementary, ArcSinesAreThoseOfTheCLibrary) {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const double sine = random.between(-1.0, 1.0);
    EXPECT_NEAR(arc_sine(sine), std::asin(sine), 8 * kUlp) << sine;
  }
  EXPECT_EQ(arc_sine(1.0), 0.5 * kPi);
  EXPECT_EQ(arc_sine(-1.0), -0.5 * kPi);
}

TEST(Elementary, LogarithmsAreThoseOfTheCLibrary) {
  Random random(4);
  for (int k = 0; k < 20000; ++k) {
    const double x = std::ldexp(random.between(0.5, 1.0), random.below(2000) - 1000);
    const double expected = std::log(x);
    EXPECT_NEAR(logarithm(x), expected, 2 * kUlp * std::max(1.0, std::abs(expected))) << x;
  }
  for (const double x : {0.9999999, 1.0000001})
    EXPECT_NEAR(logarithm(x), std::log(x), 2 * kUlp * std::abs(std::log(x)));
  EXPECT_EQ(logarithm(1.0), 0.0);
  EXPECT_NEAR(logarithm(std::numeric_limits<double>::denorm_min()), -1074 * std::numbers::ln2,
              1e-12);
}

TEST(Elementary, PowersAreThoseOfTheCLibrary) {
  Random random(5);
  for (int k = 0; k < 20000; ++k) {
    const double base = random.between(0.0, 1.0), exponent = random.between(0.01, 30.0);
    const double expected = std::pow(base, exponent);
    const double logarithms = 1.0 + std::abs(exponent * std::log(base));
    EXPECT_NEAR(power(base, exponent), expected, 2 * kUlp * logarithms * expected)
        << base << ' ' << exponent;
  }
}

TEST(Elementary, PowersOfTheEndsAreExact) {
  for (const double exponent : {0.5, 1.0, 2.5, 1e9}) {
    EXPECT_EQ(power(0.0, exponent), 0.0);
    EXPECT_EQ(power(1.0, exponent), 1.0);
  }
  EXPECT_EQ(power(0.5, 1e9), 0.0);
  EXPECT_EQ(power(0.3, 1.0), 0.3);
}

}  // namespace
}  // namespace dapple::test
