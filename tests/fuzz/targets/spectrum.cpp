// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/spectrum.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

void fuzz_plane(Bytes& bytes) {
  std::vector<std::vector<Vec2>> sets(static_cast<std::size_t>(bytes.between(1, 3)));
  for (std::vector<Vec2>& set : sets)
    for (int k = bytes.below(30); k > 0; --k) set.emplace_back(Vec2{bytes.share(), bytes.share()});
  if (!sets[0].empty() && bytes.one_in(8)) sets[0][0].x() = bytes.wild();
  const std::vector<std::span<const Vec2>> runs(sets.begin(), sets.end());
  SpectrumOptions options;
  options.half_width = bytes.between(-1, 20);
  const auto found = answer([&] { return spectrum(runs, options); });
  if (!found) return;
  for (const double power : found->periodogram) {
    EXPECT_TRUE(std::isfinite(power));
    EXPECT_GE(power, 0.0);
  }
  for (const double mean : found->radial.mean) EXPECT_TRUE(std::isfinite(mean));
}

void fuzz_on_surface(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const auto samples = take_samples(bytes, *surface, 60);
  if (!samples) return;
  SurfaceSpectrumOptions options;
  options.radius = bytes.between(0.5, 5.0);
  options.bins = 2 * bytes.between(0, 20);
  const Samples* run = &*samples;
  const auto found = answer([&] { return surface_spectrum(*surface, {&run, 1}, options); });
  if (!found) return;
  EXPECT_LE(found->centers, samples->size());
  EXPECT_EQ(found->differentials.size(), static_cast<std::size_t>(options.bins * options.bins));
  for (const double power : found->power) EXPECT_TRUE(std::isfinite(power));
}

}  // namespace

void fuzz_spectrum(Bytes& bytes) {
  if (bytes.one_in(3)) return fuzz_plane(bytes);
  fuzz_on_surface(bytes);
}

}  // namespace dapple::fuzz
