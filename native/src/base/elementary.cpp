// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

/// Taylor series on [-pi / 4, pi / 4]; the remainder is below 1e-18.
Direction small_direction(double x) {
  const double xx = x * x;
  double cosine = 0.0, sine = 0.0;
  for (int k = 18; k >= 2; k -= 2) {
    cosine = (1.0 - cosine) * (xx / (k * (k - 1)));
    sine = (1.0 - sine) * (xx / (k * (k + 1)));
  }
  return {1.0 - cosine, x * (1.0 - sine)};
}

/// atan on [0, 1] by halving the angle twice and a Taylor series, cut off below 1e-18.
double small_angle(double tangent) {
  for (int half = 0; half < 2; ++half) tangent /= 1.0 + std::sqrt(1.0 + tangent * tangent);
  const double square = tangent * tangent;
  double sum = 0.0;
  for (int k = 25; k >= 1; k -= 2) sum = 1.0 / k - square * sum;
  return 4.0 * tangent * sum;
}

/// Without branches, so that a loop computes several angles at once.
inline double angle(double y, double x) {
  const double along = std::abs(x), across = std::abs(y);
  const double most = std::max(along, across), least = std::min(along, across);
  const double small = small_angle(most > 0.0 ? least / most : 0.0);
  const double quarter = across > along ? 0.5 * std::numbers::pi - small : small;
  return std::copysign(x < 0.0 ? std::numbers::pi - quarter : quarter, y);
}

// ln 2 in two parts: integer multiples of the first one, up to 2^11, are exact.
constexpr double kLogarithmOf2 = 0x1.62e42fefap-1;  // NOLINT(modernize-use-std-numbers): a part
constexpr double kLogarithmOf2Rest = 0x1.cf79abc9e3b3ap-40;

/// e^x on [-ln 2 / 2, ln 2 / 2] by a Taylor series, cut off below 1e-18.
double small_exponential(double x) {
  double sum = 1.0;
  for (int k = 16; k >= 1; --k) sum = 1.0 + sum * x / k;
  return sum;
}

/// \param x in [-1e300, 0]
double exponential(double x) {
  constexpr double kLeast = -800.0;  // e^x is 0 to double precision
  const double twos = std::floor(std::max(x, kLeast) / std::numbers::ln2 + 0.5);
  const double rest = (std::max(x, kLeast) - twos * kLogarithmOf2) - twos * kLogarithmOf2Rest;
  return std::ldexp(small_exponential(rest), static_cast<int>(twos));
}

}  // namespace

Direction direction(double turns) {
  const double part = turns - std::floor(turns + 0.5);
  const double quarter = std::floor(4.0 * part + 0.5);
  const auto [c, s] = small_direction(2.0 * std::numbers::pi * (part - 0.25 * quarter));
  switch (static_cast<int>(quarter)) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case -1:
      return {s, -c};
    default:
      return {-c, -s};
  }
}

double angle_of(double y, double x) { return angle(y, x); }

void angles_of(std::span<const double> y, std::span<const double> x, std::span<double> angles) {
  for (std::size_t k = 0; k < angles.size(); ++k) angles[k] = angle(y[k], x[k]);
}

double arc_sine(double sine) { return angle_of(sine, std::sqrt((1.0 - sine) * (1.0 + sine))); }

double logarithm(double x) {
  int twos = 0;
  double part = std::frexp(x, &twos);  // in [1/2, 1); below in [sqrt(1/2), sqrt(2)]
  if (part < 0.5 * std::numbers::sqrt2) {
    part *= 2.0;
    --twos;
  }
  const double s = (part - 1.0) / (part + 1.0);  // ln part = 2 artanh s; cut off below 1e-18
  double sum = 0.0;
  for (int k = 23; k >= 1; k -= 2) sum = 1.0 / k + s * s * sum;
  return twos * kLogarithmOf2 + (twos * kLogarithmOf2Rest + 2.0 * s * sum);
}

double power(double base, double exponent) {
  if (base == 0.0 || exponent == 1.0) return base;
  return exponential(exponent * logarithm(base));
}

}  // namespace dapple
