// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/stipple.hpp>
#include <numeric>
#include <utility>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// Inks mix to the colors that they were separated from.
void fuzz_inks(Bytes& bytes) {
  ColorImage picture;
  picture[0] = take_image(bytes);
  picture[1] = picture[2] = picture[0];
  for (std::size_t k = 1; k < 3; ++k)
    for (double& value : picture[k].values) value = bytes.share();
  const auto inks = answer([&] { return separate_inks(picture); });
  if (!inks) return;
  const ColorImage back = mix_inks(*inks);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t k = 0; k < picture[channel].values.size(); ++k)
      EXPECT_NEAR(back[channel].values[k], picture[channel].values[k], 1e-12);
}

std::vector<Image> take_inks(Bytes& bytes) {
  std::vector<Image> inks = {take_image(bytes)};
  for (int k = bytes.below(3); k > 0; --k) {
    inks.push_back(inks[0]);
    for (double& value : inks.back().values) value = bytes.byte() / 255.0;
    take_zeros(bytes, inks.back());
  }
  return inks;
}

/// The pixels along one axis that hold a coordinate: two where it is between them.
std::pair<std::size_t, std::size_t> pixels_at(double x, std::size_t count) {
  const double floor = std::floor(x), last = static_cast<double>(count) - 1.0;
  const auto pixel = [&](double k) { return static_cast<std::size_t>(std::clamp(k, 0.0, last)); };
  return {pixel(x > floor ? floor : floor - 1.0), pixel(floor)};
}

/// Whether a pixel at a point has some of the ink.
bool is_inked(const Image& ink, const Vec2& p) {
  const auto [left, right] = pixels_at(p.x(), ink.columns);
  const auto [low, high] = pixels_at(p.y(), ink.rows);
  for (std::size_t row = low; row <= high; ++row)
    for (std::size_t column = left; column <= right; ++column)
      if (ink.values[row * ink.columns + column] > 0.0) return true;
  return false;
}

void expect_dots(const Stipples& dots, const Image& ink, std::size_t count) {
  EXPECT_EQ(dots.positions.size(), count);
  EXPECT_EQ(dots.classes.size(), count);
  EXPECT_GT(dots.radius, 0.0);
  for (const Vec2& p : dots.positions) {
    EXPECT_GE(p.minCoeff(), 0.0);
    EXPECT_LE(p.x(), static_cast<double>(ink.columns));
    EXPECT_LE(p.y(), static_cast<double>(ink.rows));
  }
}

}  // namespace

void fuzz_stipple(Bytes& bytes) {
  if (bytes.one_in(8)) return fuzz_inks(bytes);
  const std::vector<Image> inks = take_inks(bytes);
  StippleOptions options;
  take_options(bytes, options);
  if (bytes.one_in(4))
    for (std::size_t k = 0; k < inks.size(); ++k) options.counts.push_back(bytes.below(30));
  const std::size_t count =
      options.counts.empty() || bytes.one_in(8)
          ? take_count(bytes)
          : std::accumulate(options.counts.begin(), options.counts.end(), std::size_t{0});
  const auto dots = answer_of_threads([&](int threads) {
    options.threads = threads;
    return stipple_inks(inks, count, options);
  });
  if (!dots) return;
  expect_dots(*dots, inks[0], count);
  for (std::size_t k = 0; k < dots->positions.size(); ++k) {
    const Vec2& p = dots->positions[k];
    EXPECT_TRUE(is_inked(inks[static_cast<std::size_t>(dots->classes[k])], p))
        << "dot " << k << " at (" << p.x() << ", " << p.y() << ") is where its ink is 0";
  }
  for (std::size_t c = 0; c < options.counts.size(); ++c)
    EXPECT_EQ(count_of(dots->classes, static_cast<std::int32_t>(c)), options.counts[c]);
}

}  // namespace dapple::fuzz
