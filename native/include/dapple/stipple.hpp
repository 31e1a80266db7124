// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sampler.hpp>
#include <dapple/types.hpp>

namespace dapple {

/// The inks that a color picture is separated into, in this order; the index of an ink is the class
/// of its dots.
enum class Ink { kRed, kGreen, kBlue, kCyan, kMagenta, kYellow, kBlack };
inline constexpr std::size_t kInks = 7;

/// Red, green and blue of a picture, each in [0, 1] and of one shape.
using ColorImage = std::array<Image, 3>;

/// Separate a picture into coverages of inks, in [0, 1] per pixel; 1 - their sum is paper.
///
/// With c = 1 - red, m = 1 - green, y = 1 - blue: black takes the part common to all three, then
/// blue (c and m), green (c and y) or red (m and y) the part common to the remaining two, then
/// cyan, magenta or yellow the rest of one. At most one of each three is used, and all together
/// cover max(c, m, y).
/// \throw ArgumentError naming the channel and its first value that is not in [0, 1], or a channel
/// of another shape
[[nodiscard]] std::array<Image, kInks> separate_inks(const ColorImage& picture);

/// The color of coverages printed side by side: the inverse of separate_inks().
[[nodiscard]] ColorImage mix_inks(const std::array<Image, kInks>& inks);

struct StippleOptions {
  // With the default 0 the tone is right wherever dots do not overlap. In nearly black areas, where
  // they must, 1.1 times the automatic radius leaves no gap.
  /// Radius of every dot; with 0 all dots together have the area of ink in the picture.
  double radius = 0.0;  // expert, >= 0, pixels
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;  // basic, >= 0
  /// Mu, the weight of the evenness of all classes together, relative to that of each class.
  double union_weight = 1.0;  // expert, >= 0
  // A smaller tolerance makes no visible difference.
  OptimizerOptions optimizer = {.tolerance = 2e-4};  // options
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Dots of each ink; empty: in proportion to the sums of the coverages, by largest remainders.
  std::vector<std::size_t> counts = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const StippleOptions& options);

struct Stipples {
  std::vector<Vec2> positions;        ///< in pixels: pixel (row, column) is [column, column + 1] x
                                      ///< [row, row + 1]
  std::vector<std::int32_t> classes;  ///< index of each dot's ink
  double radius = 0.0;                ///< of each dot, in pixels
  Report report;  ///< evaluations and iterations are those of each ink alone and of all together
};

/// Exactly `count` dots that render coverages of one or several inks: error diffusion, then the
/// planar optimization on a density that is constant on each pixel (paper, sections 5.1 and 5.2).
/// \param inks coverages >= 0, of one shape; a gray picture is one ink, 1 - gray
/// \throw ArgumentError for a count of 0, options out of range, a picture that is not of one shape,
/// has a value that is negative or not finite (the first is named), or no ink at all; Cancelled
[[nodiscard]] Stipples stipple_inks(std::span<const Image> inks, std::size_t count,
                                    const StippleOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
