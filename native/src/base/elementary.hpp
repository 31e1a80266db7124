// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace dapple {

// Sines and angles from + - * / and square roots alone, which IEEE 754 rounds in one way: those of
// C libraries differ in their last bits, between systems and between processors.

struct Direction {
  double cosine;
  double sine;
};

/// Of the angle 2 pi `turns`, to 2^-52.
[[nodiscard]] Direction direction(double turns);

/// As atan2(y, x), in [-pi, pi], to a relative 2^-50.
[[nodiscard]] double angle_of(double y, double x);

/// \param sine in [-1, 1]
[[nodiscard]] double arc_sine(double sine);

}  // namespace dapple
