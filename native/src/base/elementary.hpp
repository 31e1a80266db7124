// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace dapple {

// From + - * / and square roots alone, which IEEE 754 rounds in one way: the functions of C
// libraries differ in their last bits, between systems and between processors.

struct Direction {
  double cosine;
  double sine;
};

/// Sine and cosine of the angle 2 pi `turns`, to 2^-52.
[[nodiscard]] Direction direction(double turns);

/// As atan2(y, x), in [-pi, pi], to a relative 2^-50.
[[nodiscard]] double angle_of(double y, double x);

/// angle_of() each y and x, side by side. \param angles receives as many
void angles_of(std::span<const double> y, std::span<const double> x, std::span<double> angles);

/// \param sine in [-1, 1]
[[nodiscard]] double arc_sine(double sine);

/// The natural logarithm, to 2^-51 relative to it or to 1.
/// \param x finite, > 0
[[nodiscard]] double logarithm(double x);

/// base^exponent, to a relative 2^-51 for each unit of its logarithm; exact for a base of 0 or 1
/// and for an exponent of 1. \param base in [0, 1] \param exponent finite, > 0
[[nodiscard]] double power(double base, double exponent);

}  // namespace dapple
