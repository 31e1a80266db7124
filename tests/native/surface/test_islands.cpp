// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/islands.hpp"

namespace dapple::test {
namespace {

/// A square whose faces form a checkerboard of density 0 and 1, or one with bridges between its
/// fields.
Shape board(int cells, int fields, bool bridges) {
  return with_face_density(grid(cells), [=](const Vec3& p) {
    const double x = p.x() * fields, y = p.y() * fields;
    if (bridges && std::abs(y - std::floor(y) - 0.5) < 0.1) return 1.0;
    return (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0 ? 1.0 : 0.0;
  });
}

TEST(Islands, AreTheComponentsWhereThereIsDensityEverywhere) {
  const Surface surface = two_components().surface();
  const Islands islands(surface);
  EXPECT_FALSE(islands.has_gaps());
  EXPECT_EQ(islands.count(), 2u);
}

TEST(Islands, AreNumberedInTheOrderOfTheirFirstFaces) {
  const std::vector<std::int32_t> whole = islands(two_components().surface());
  EXPECT_EQ(whole.front(), 0);
  EXPECT_EQ(whole.back(), 1);
  const Surface surface = board(24, 6, false).surface();
  const std::vector<std::int32_t> found = islands(surface);
  const std::vector<double> density = surface.density();
  std::int32_t next = 0;
  for (std::size_t f = 0; f < found.size(); ++f) {
    EXPECT_LE(found[f], next);
    if (found[f] == next) ++next;
    EXPECT_EQ(found[f] < 0, density[f] == 0.0) << f;
  }
  EXPECT_EQ(next, 18);
}

TEST(Islands, ADoubledFaceIsInNone) {
  const Shape shape = joined(grid(2), grid(2));
  const std::vector<std::int32_t> found = islands(shape.surface());
  for (std::size_t f = 0; f < found.size(); ++f)
    EXPECT_EQ(found[f], f < found.size() / 2 ? 0 : -1) << f;
}

TEST(Islands, ThatTouchAtACornerAreTwo) {
  const Surface surface = board(24, 6, false).surface();
  const Islands islands(surface);
  EXPECT_TRUE(islands.has_gaps());
  EXPECT_EQ(islands.count(), 1u + 18u);
  EXPECT_EQ(islands.capacities()[0], 0.0);
  for (std::size_t k = 1; k < islands.count(); ++k)
    EXPECT_NEAR(islands.capacities()[k], surface.capacity() / 18.0, 1e-12);
}

TEST(Islands, AnEdgeWithoutDensityParts) {
  // The density of the vertices falls to 0 from both sides of the line x = 1/2.
  const Shape shape = with_density(grid(8), [](const Vec3& p) { return std::abs(p.x() - 0.5); });
  EXPECT_EQ(Islands(shape.surface()).count(), 1u);  // there is no gap, so faces are not visited
  const Shape gap = with_density(
      grid(8), [](const Vec3& p) { return std::max(0.0, std::abs(p.x() - 0.5) - 0.125); });
  EXPECT_EQ(Islands(gap.surface()).count(), 3u);
}

TEST(Islands, EachGetsItsShareOfTheSamples) {
  const Surface surface = board(48, 6, false).surface();
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    SampleOptions options;
    options.seed = seed;
    const Samples samples = sample(surface, 1000, options);
    check(surface, samples);
    const Islands islands(surface);
    std::vector<int> counts(islands.count(), 0);
    for (const std::int32_t face : samples.faces)
      ++counts[islands.at(surface.ordered().ordered_face(face))];
    EXPECT_EQ(counts[0], 0);
    for (std::size_t k = 1; k < counts.size(); ++k) EXPECT_NEAR(counts[k], 1000.0 / 18.0, 1.0);
    EXPECT_GT(samples.report.whole_count_variation, 0.0);
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.015);
  }
}

/// Sites beside gaps want to go far, but they hold back no others.
TEST(Islands, TakeAboutAsManyEvaluationsAsAWholeSurface) {
  const Surface surface = with_density(grid(120), [](const Vec3& p) {
                            const double wave =
                                std::sin(40.0 * p.x() + 2.0 * std::sin(5.0 * p.y())) *
                                std::sin(32.0 * p.y() + std::sin(9.0 * p.x()));
                            return std::clamp(3.0 * (wave + 0.25), 0.0, 1.0);
                          }).surface();
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SampleOptions options;
    options.seed = seed;
    const Report report = sample(surface, 2000, options).report;
    EXPECT_LE(report.evaluations, 14) << seed;
    EXPECT_LE(report.evenness.capacity_variation, 0.005) << seed;
  }
}

TEST(Islands, WithBridgesGetTheRightNumbersToo) {
  const Surface surface = board(120, 6, true).surface();
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    SampleOptions options;
    options.seed = seed;
    const Samples samples = sample(surface, 2000, options);
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.015) << seed;
    EXPECT_GE(samples.report.evenness.alpha_min, 0.5) << seed;
  }
}

TEST(Islands, OfEachClassToo) {
  const Surface surface = board(48, 4, false).surface();
  const std::vector<SampleClass> classes = {{.count = 300}, {.count = 900}};
  const Samples samples = sample_classes(surface, classes, {});
  for (const Quality& quality : samples.report.classes)
    EXPECT_LE(quality.evenness.capacity_variation, 0.05);
}

TEST(Islands, ResamplingKeepsTheirShares) {
  const Surface surface = board(48, 6, false).surface();
  const Samples more = resample(surface, sample(surface, 800), 1000);
  EXPECT_LE(more.report.evenness.capacity_variation, 0.02);
}

}  // namespace
}  // namespace dapple::test
