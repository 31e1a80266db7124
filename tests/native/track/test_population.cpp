// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <iostream>
#include <map>
#include <numbers>
#include <set>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 200;
constexpr int kFade = 5;
constexpr int kPeriod = 24;

/// A body that grows to 1.4 times its length and shrinks back.
std::vector<Vec3> frame_of(const Shape& shape, int frame) {
  const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * frame / kPeriod);
  return mapped(shape,
                [share](const Vec3& p) { return Vec3((1.0 + 0.4 * share) * p.x(), p.y(), p.z()); })
      .vertices;
}

Population population_of(const Shape& shape) {
  const Surface surface = shape.surface();
  return Population(surface, sample(surface, kCount), {.fade = kFade});
}

TEST(Population, KeepsTheDensity) {
  const Shape shape = blob(4);
  Population population = population_of(shape);
  const double density = kCount / population.surface().capacity();
  std::size_t most = 0;
  for (int frame = 1; frame <= kPeriod; ++frame) {
    const Samples& samples = population.advance(frame_of(shape, frame));
    double there = 0.0;  // samples that do not vanish
    const std::size_t staying = samples.report.count;
    for (std::size_t k = 0; k < staying; ++k) there += 1.0;
    EXPECT_NEAR(there, density * population.surface().capacity(), 1.0) << "frame " << frame;
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.02) << "frame " << frame;
    most = std::max(most, staying);
  }
  EXPECT_GT(most, kCount + 20);
}

/// The density is 100 times as high on a cap. Where the surface grows uniformly, all regions gain
/// samples in proportion.
TEST(Population, KeepsTheSharesUnderADensity) {
  constexpr std::uint64_t kSeeds = 5;
  const Shape shape =
      with_face_density(icosphere(4), [](const Vec3& p) { return p.z() > 0.875 ? 100.0 : 1.0; });
  const Surface surface = shape.surface();
  double worst = 0.0, worst_share = 0.0;  // of all frames, means of the starts
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SampleOptions options;
    options.seed = seed;
    Population population(surface, sample(surface, 800, options), {.fade = kFade});
    const auto dense_share = [&population] {
      const Samples& samples = population.samples();
      double dense = 0.0;
      for (std::size_t k = 0; k < samples.report.count; ++k)
        dense += samples.positions[k].normalized().z() > 0.875 ? 1.0 : 0.0;
      return dense / static_cast<double>(samples.report.count);
    };
    const double first = dense_share();
    double variation = 0.0, off = 0.0;
    for (int frame = 1; frame <= 12; ++frame) {
      const double size = 1.0 + 0.05 * std::sin(2.0 * std::numbers::pi * frame / 12);
      population.advance(mapped(shape, [&](const Vec3& p) { return Vec3(size * p); }).vertices);
      off = std::max(off, std::abs(dense_share() - first));
      variation = std::max(variation, population.samples().report.evenness.capacity_variation);
    }
    worst += variation / kSeeds;
    worst_share += off / kSeeds;
  }
  EXPECT_LE(worst, 0.03);
  EXPECT_LE(worst_share, 0.01);
}

/// The samples of one class that stay, as separate samples.
Samples staying(const Population& population, std::int32_t one) {
  const Samples& all = population.samples();
  std::vector<std::int32_t> faces;
  std::vector<Vec3> barycentric;
  for (std::size_t k = 0; k < all.report.count; ++k) {
    if (all.classes[k] != one) continue;
    faces.push_back(all.faces[k]);
    barycentric.push_back(all.barycentric[k]);
  }
  return bind_samples(population.surface(), faces, barycentric);
}

TEST(Population, KeepsTheDensityOfEachClass) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const std::vector<SampleClass> classes = {{.count = 150}, {.count = 50}};
  Population population(surface, sample_classes(surface, classes),
                        {.fade = kFade, .tracker = {.classes = classes}});
  std::map<std::int32_t, std::int32_t> class_of;
  double worst = 0.0, least = 1.0;
  for (int frame = 1; frame <= kPeriod; ++frame) {
    const Samples& samples = population.advance(frame_of(shape, frame));
    const double growth = population.surface().capacity() / surface.capacity();
    for (const std::int32_t one : {0, 1}) {
      const Samples own = staying(population, one);
      EXPECT_NEAR(static_cast<double>(own.size()), growth * (one == 0 ? 150.0 : 50.0), 1.0);
      const Report report = analyze(population.surface(), own);
      worst = std::max(worst, report.evenness.capacity_variation);
      least = std::min(least, report.evenness.alpha_min);
    }
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const auto [known, is_new] = class_of.emplace(samples.ids[k], samples.classes[k]);
      EXPECT_EQ(known->second, samples.classes[k]) << "id " << samples.ids[k];
    }
  }
  std::cout << "capacity variation " << worst << ", alpha " << least << '\n';
  EXPECT_GT(class_of.size(), 220u) << "none were born";
  EXPECT_LE(worst, 0.06);
  EXPECT_GE(least, 0.35);
}

/// A class with density only in the upper half grows there and not below.
TEST(Population, KeepsTheDensityOfAClassWithADensityOfItsOwn) {
  const Shape shape =
      with_face_density(icosphere(3), [](const Vec3& p) { return p.z() > 0.0 ? 1.0 : 0.0; });
  const Surface surface(shape.vertices, shape.faces);
  const Surface above = surface.with_density({DensityAt::kFaces, shape.density});
  const std::vector<SampleClass> classes = {{.count = 60, .surface = above}, {.count = 60}};
  Population population(surface, sample_classes(surface, classes),
                        {.fade = kFade, .tracker = {.classes = classes}});
  for (int frame = 1; frame <= 8; ++frame) {
    const double height = 1.0 + 0.1 * frame;
    population.advance(mapped(shape, [height](const Vec3& p) {
                         return Vec3(p.x(), p.y(),
                                     std::max(p.z(), 0.0) * height + std::min(p.z(), 0.0));
                       }).vertices);
  }
  const double growth =
      above.deformed(population.surface().vertices()).capacity() / above.capacity();
  const Samples own = staying(population, 0);
  EXPECT_NEAR(static_cast<double>(own.size()), 60.0 * growth, 1.0);
  for (const Vec3& place : own.positions) EXPECT_GT(place.z(), -0.2);
  EXPECT_LT(staying(population, 1).size(), own.size());
}

TEST(Population, FadesByOneStepAFrameAndNeverPops) {
  const Shape shape = blob(4);
  Population population = population_of(shape);
  std::map<std::int32_t, double> last;
  std::set<std::int32_t> gone;
  for (const std::int32_t id : population.samples().ids) last[id] = 1.0;
  for (int frame = 1; frame <= 2 * kPeriod; ++frame) {
    const Samples& samples = population.advance(frame_of(shape, frame));
    ASSERT_EQ(samples.fade.size(), samples.size());
    ASSERT_EQ(samples.positions.size(), samples.faces.size());
    std::map<std::int32_t, double> now;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      EXPECT_TRUE(now.emplace(samples.ids[k], samples.fade[k]).second) << "an id twice";
      EXPECT_FALSE(gone.contains(samples.ids[k])) << "an id used again";
      const double before = last.contains(samples.ids[k]) ? last[samples.ids[k]] : 0.0;
      EXPECT_LE(std::abs(samples.fade[k] - before), 1.0 / kFade + 1e-12);
    }
    for (const auto& [id, fade] : last)
      if (!now.contains(id)) {
        EXPECT_LE(fade, 1.0 / kFade + 1e-12) << "vanished from " << fade;
        gone.insert(id);
      }
    last = std::move(now);
  }
  EXPECT_GT(gone.size(), 20u);
}

TEST(Population, KeepsTheCountOfABodyThatOnlyMoves) {
  const Shape shape = blob(4);
  Population population = population_of(shape);
  const Samples first = population.samples();
  const Samples& next = population.advance(
      mapped(shape, [](const Vec3& p) { return Vec3(rotated(p, 0.6) + Vec3(4, 0, 0)); }).vertices);
  EXPECT_EQ(next.ids, first.ids);
  EXPECT_EQ(next.faces, first.faces);
}

TEST(Population, GivesTheSameBytesAgain) {
  const Shape shape = blob(3);
  Population one = population_of(shape), two = population_of(shape);
  for (int frame = 1; frame <= 6; ++frame) {
    const Samples& a = one.advance(frame_of(shape, frame));
    const Samples& b = two.advance(frame_of(shape, frame));
    EXPECT_TRUE(same_bytes(a.positions, b.positions));
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.fade, b.fade);
  }
}

TEST(Population, IsUnchangedByABadFrame) {
  const Shape shape = blob(3);
  Population population = population_of(shape);
  population.advance(frame_of(shape, 3));
  const Samples before = population.samples();
  std::vector<Vec3> bad = shape.vertices;
  bad.pop_back();
  EXPECT_THROW(population.advance(bad), SurfaceError);
  EXPECT_TRUE(same_bytes(population.samples().positions, before.positions));
}

TEST(Population, RefusesNoFrames) {
  const Surface surface = blob(2).surface();
  expect_message<ArgumentError>([&] { Population(surface, sample(surface, 5), {.fade = 0}); },
                                {"fade", "0"});
}

std::vector<Vec3> grown(const Shape& shape, double factor) {
  return mapped(shape, [&](const Vec3& p) { return Vec3(factor * p); }).vertices;
}

TEST(Population, RefusesToGrowWithoutBound) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  Population population(surface, sample(surface, 20));
  const Samples before = population.samples();
  for (const double factor : {1e4, 1e60})
    expect_message<ArgumentError>([&] { population.advance(grown(shape, factor)); },
                                  {"20", "samples", "100000000"});
  EXPECT_TRUE(same_bytes(population.samples(), before));
  EXPECT_TRUE(same_bytes(population.surface().vertices(), shape.vertices));
}

TEST(Population, NamesIdsThatAreUsedUp) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const Samples some = sample(surface, 20);
  std::vector<std::int32_t> ids = some.ids;
  ids[3] = 2147483647;
  const Samples last = bind_samples(surface, some.faces, some.barycentric, ids);
  Population population(surface, last);
  EXPECT_EQ(population.advance(shape.vertices).size(), 20u);
  const Samples before = population.samples();
  expect_message<ArgumentError>([&] { population.advance(grown(shape, 1.5)); },
                                {"ids", "2147483647"});
  EXPECT_TRUE(same_bytes(population.samples(), before));
}

}  // namespace
}  // namespace dapple::test
