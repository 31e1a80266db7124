// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <dapple/spectrum.hpp>
#include <limits>
#include <numbers>

#include "base/elementary.hpp"

namespace dapple {

/// Accumulates mean and variance over annuli (Welford 1962: one pass, no cancellation).
class Annuli {
 public:
  explicit Annuli(std::size_t count) : annuli_(count) {}

  void add(std::size_t annulus, double value) {
    if (annulus >= annuli_.size()) return;
    Sums& sums = annuli_[annulus];
    const double off = value - sums.mean;
    sums.count += 1.0;
    sums.mean += off / sums.count;
    sums.squares += off * (value - sums.mean);
  }

  /// The middle of annulus k is (k + first) * width.
  [[nodiscard]] RadialStatistics statistics(double first, double width) const {
    RadialStatistics result;
    for (std::size_t k = 0; k < annuli_.size(); ++k) {
      result.radius.push_back((static_cast<double>(k) + first) * width);
      result.mean.push_back(annuli_[k].mean);
      result.anisotropy.push_back(decibels(annuli_[k]));
    }
    return result;
  }

 private:
  struct Sums {
    double count = 0.0;
    double mean = 0.0;
    double squares = 0.0;  // sum of the squared deviations from the mean
  };

  static double decibels(const Sums& sums) {
    if (sums.squares <= 0.0 || sums.count < 2.0) return -std::numeric_limits<double>::infinity();
    const double ratio = sums.squares / (sums.count - 1.0) / (sums.mean * sums.mean);
    return 10.0 / std::numbers::ln10 * logarithm(ratio);
  }

  std::vector<Sums> annuli_;
};

/// The statistics of (2 half_width + 1)^2 values over frequencies that are equal at f and -f: one
/// of each pair, the annuli a step wide about the multiples of the step.
[[nodiscard]] inline RadialStatistics radial_statistics(const std::vector<double>& values,
                                                        int half_width, double step) {
  Annuli annuli(static_cast<std::size_t>(half_width));
  auto value = values.begin() + (values.end() - values.begin()) / 2 + 1;
  int x = 1;
  for (int y = 0; y <= half_width; ++y, x = -half_width)
    for (; x <= half_width; ++x, ++value)
      annuli.add(
          static_cast<std::size_t>(std::lround(std::sqrt(double(x) * x + double(y) * y))) - 1,
          *value);
  return annuli.statistics(1.0, step);
}

}  // namespace dapple
