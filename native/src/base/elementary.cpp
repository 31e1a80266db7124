// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

/// Taylor's series on [-pi / 4, pi / 4]: what is left out is below 1e-18.
Direction small_direction(double x) {
  const double xx = x * x;
  double cosine = 0.0, sine = 0.0;
  for (int k = 18; k >= 2; k -= 2) {
    cosine = (1.0 - cosine) * (xx / (k * (k - 1)));
    sine = (1.0 - sine) * (xx / (k * (k + 1)));
  }
  return {1.0 - cosine, x * (1.0 - sine)};
}

/// atan on [0, 1]: the angle is halved twice, then Taylor's series, cut below 1e-18.
double small_angle(double tangent) {
  for (int half = 0; half < 2; ++half) tangent /= 1.0 + std::sqrt(1.0 + tangent * tangent);
  const double square = tangent * tangent;
  double sum = 0.0;
  for (int k = 25; k >= 1; k -= 2) sum = 1.0 / k - square * sum;
  return 4.0 * tangent * sum;
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

double angle_of(double y, double x) {
  const double along = std::abs(x), across = std::abs(y);
  const double most = std::max(along, across);
  double angle = most > 0.0 ? small_angle(std::min(along, across) / most) : 0.0;
  if (across > along) angle = 0.5 * std::numbers::pi - angle;
  if (x < 0.0) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
}

double arc_sine(double sine) { return angle_of(sine, std::sqrt((1.0 - sine) * (1.0 + sine))); }

}  // namespace dapple
