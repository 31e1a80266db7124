// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/classes.hpp>
#include <dapple/image.hpp>

namespace dapple {

/// The inks that a color picture is separated into, in this order; a stipple of one is the class.
enum class Ink { kRed, kGreen, kBlue, kCyan, kMagenta, kYellow, kBlack };
inline constexpr std::size_t kInks = 7;

/// Red, green and blue of a picture, each in [0, 1] and of one shape.
using ColorImage = std::array<Image, 3>;

/// How much of each pixel each ink covers, in [0, 1]; 1 - the sum is paper.
///
/// With c = 1 - red, m = 1 - green, y = 1 - blue: black takes what all three have in common, then
/// blue (c and m), green (c and y) or red (m and y) what the two others have in common, then cyan,
/// magenta or yellow what is left of one. At most one of each three is there, and all together
/// cover max(c, m, y).
/// \throw ArgumentError naming the channel and its first value that is not in [0, 1], or a channel
/// of another shape
[[nodiscard]] std::array<Image, kInks> separate(const ColorImage& picture);

/// The color that coverages mix to side by side: the inverse of separate().
[[nodiscard]] ColorImage mix(const std::array<Image, kInks>& inks);

struct StippleOptions {
  std::uint64_t seed = 0;
  OptimizerOptions optimizer = {.tolerance = 2e-4};  // more is not seen from afar
  double union_weight = 1.0;
  /// Dots of each ink; empty: in proportion to the sums of the coverages, by largest remainders.
  std::vector<std::size_t> counts = {};
  /// 0: pi r^2 n = sum of the coverages. The tone is then right wherever dots do not overlap; where
  /// they must, in what is nearly black, 1.1 times as much leaves no gap.
  double radius = 0.0;
  int threads = 0;
};

inline constexpr std::tuple kStippleOptions = {
    Option{"radius",
           &StippleOptions::radius,
           {},
           "pixels",
           Level::kExpert,
           "Of every dot; 0 is where all dots together have the area of the ink that the picture "
           "asks for."},
    seed_option(&StippleOptions::seed), union_weight_option(&StippleOptions::union_weight),
    Group{&StippleOptions::optimizer}, threads_option(&StippleOptions::threads)};

constexpr const auto& options_of(const StippleOptions&) { return kStippleOptions; }

struct Stipples {
  std::vector<Vec2> positions;        ///< in pixels: pixel (row, column) is [column, column + 1] x
                                      ///< [row, row + 1]
  std::vector<std::int32_t> classes;  ///< which ink each is of, in order
  double radius = 0.0;                ///< of each dot, in pixels
  Report report;  ///< evaluations and iterations are those of each ink alone and of all together
};

/// Exactly `count` dots that render coverages of one or several inks: error diffusion, then the
/// planar optimization on a density that is constant on each pixel (paper, sections 5.1 and 5.2).
/// \param inks coverages >= 0, of one shape; a gray picture is one ink, 1 - gray
/// \throw ArgumentError for a count of 0, options out of range, a picture that is not of one shape,
/// has a value that is negative or not finite (the first is named), or no ink at all; Cancelled
[[nodiscard]] Stipples stipple(std::span<const Image> inks, std::size_t count,
                               const StippleOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
