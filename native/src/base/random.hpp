// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace dapple {

/// SplitMix64 (Steele, Lea and Flood 2014). The standard library's distributions differ between
/// implementations; this gives the same numbers everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += kStep;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// The generator after so many numbers.
  [[nodiscard]] Random after(std::uint64_t numbers) const {
    return Random(state_ + numbers * kStep);
  }
  bool operator==(const Random&) const = default;

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;  // 2^64 / the golden ratio, odd

  std::uint64_t state_;
};

}  // namespace dapple
