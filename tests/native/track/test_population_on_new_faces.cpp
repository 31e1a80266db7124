// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies whose faces change from frame to frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <map>
#include <set>

#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Body = std::function<Shape(int)>;

constexpr int kFade = 4;

PopulationOptions options_of(int threads = 0) {
  PopulationOptions options{.fade = kFade};
  options.tracker.threads = threads;
  return options;
}

/// Check the rules that hold in every frame.
class Follower {
 public:
  Follower(const Surface& first, std::size_t count)
      : population_(first, sample(first, count), options_of()), area_(first.area()) {
    note();
  }

  void advance(const Surface& next) {
    const auto before = static_cast<double>(population_.samples().report.count);
    const Samples& samples = population_.advance(next);
    const Report& report = samples.report;
    const double change = std::abs(next.area() / area_ - 1.0);
    area_ = next.area();
    // If the count follows the area, fractions of several frames can be rounded up in one of them.
    EXPECT_LE(static_cast<double>(report.births + report.deaths), (change + 0.005) * before + 1.0);
    EXPECT_LE(report.slide_max, 0.45 + 1e-9);
    const double wanted = density() * area_;
    EXPECT_NEAR(static_cast<double>(report.count), wanted, 0.0025 * wanted + 1.0);
    check_on_surface(population_.surface(), sites_of(samples), samples.barycentric);
    check_fades(samples);
    note();
    births += report.births;
    deaths += report.deaths;
    alpha_min = std::min(alpha_min, report.evenness.alpha_min);
    variation = std::max(variation, report.evenness.capacity_variation);
  }

  [[nodiscard]] const Samples& samples() const { return population_.samples(); }

  std::size_t births = 0, deaths = 0;
  double alpha_min = 1.0, variation = 0.0;

 private:
  [[nodiscard]] double density() const { return first_count_ / first_area_; }

  void check_fades(const Samples& samples) {
    std::set<std::int32_t> now;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      EXPECT_TRUE(now.insert(samples.ids[k]).second) << "an id twice";
      const bool is_new = !fades_.contains(samples.ids[k]);
      EXPECT_FALSE(is_new && samples.ids[k] <= last_id_) << "an id used again";
      const double before = is_new ? 0.0 : fades_[samples.ids[k]];
      EXPECT_LE(std::abs(samples.fade[k] - before), 1.0 / kFade + 1e-12);
    }
  }

  void note() {
    const Samples& samples = population_.samples();
    if (first_count_ == 0.0) first_count_ = static_cast<double>(samples.size());
    fades_.clear();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      fades_[samples.ids[k]] = samples.fade[k];
      last_id_ = std::max(last_id_, samples.ids[k]);
    }
  }

  Population population_;
  double area_, first_area_ = area_, first_count_ = 0.0;
  std::map<std::int32_t, double> fades_;
  std::int32_t last_id_ = -1;
};

Follower followed(const Body& body, int frames, std::size_t count) {
  Follower follower(body(0).surface(), count);
  for (int frame = 1; frame <= frames; ++frame) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    follower.advance(body(frame).surface());
  }
  return follower;
}

TEST(PopulationOnNewFaces, FollowsBallsThatMergeAndSplit) {
  // Rounding decides which samples are born, so a single run says little.
  std::vector<double> last, nearest;
  for (const std::size_t count : {600u, 602u, 604u}) {
    const Follower found = followed([](int frame) { return metaballs(frame, 24); }, 24, count);
    EXPECT_GT(found.births, 20u);
    EXPECT_GT(found.deaths, 20u);
    // When the balls separate, a 20th of the surface is new in one frame.
    EXPECT_LE(found.variation, 0.08);
    nearest.push_back(found.alpha_min);
    last.push_back(found.samples().report.evenness.capacity_variation);
  }
  // Of twelve runs the median is 0.46 to 0.48, and one in twelve is below 0.3.
  std::sort(nearest.begin(), nearest.end());
  EXPECT_GE(nearest[1], 0.4);
  EXPECT_GE(nearest[0], 0.2);
  std::sort(last.begin(), last.end());
  EXPECT_LE(last[1], 0.005);
  EXPECT_LE(last[2], 0.01);
}

TEST(PopulationOnNewFaces, KeepsAllSamplesOfARemeshedBody) {
  const Follower found = followed(remeshed, 12, 500);
  EXPECT_EQ(found.births, 0u);
  EXPECT_EQ(found.deaths, 0u);
  EXPECT_GE(found.alpha_min, 0.6);
  EXPECT_LE(found.variation, 0.01);
}

TEST(PopulationOnNewFaces, KeepsTheSamplesOfATearingCloth) {
  const Follower found = followed([](int frame) { return torn_cloth(frame, 20); }, 20, 400);
  EXPECT_LE(found.births + found.deaths, 20u);
  EXPECT_GE(found.alpha_min, 0.5);
  EXPECT_LE(found.variation, 0.02);
}

TEST(PopulationOnNewFaces, CostsNothingWhereTheSurfaceIsTheSame) {
  const Shape shape = remeshed(0);
  Population population(shape.surface(), sample(shape.surface(), 300), options_of());
  const Samples before = population.samples();
  for (int frame = 0; frame < 3; ++frame) {
    const Samples& after = population.advance(shape.surface());
    EXPECT_TRUE(same_bytes(after.positions, before.positions));
    EXPECT_EQ(after.ids, before.ids);
    EXPECT_EQ(after.report.evaluations, 0);
  }
  population.advance(remeshed(1).surface());
  while (population.advance(remeshed(1).surface()).report.evaluations > 0) {
  }
  const Samples rests = population.samples();
  EXPECT_TRUE(same_bytes(population.advance(remeshed(1).surface()), rests));
}

TEST(PopulationOnNewFaces, IsTheSameAsForVerticesWhereConnectionsAre) {
  const Shape shape = blob(3);
  const auto at = [&](int frame) {
    Shape moved = shape;
    moved.vertices = deformed(shape.vertices, 0.1 * frame);
    return moved;
  };
  Population one(at(0).surface(), sample(at(0).surface(), 200));
  Population two = one;
  for (int frame = 1; frame <= 4; ++frame) {
    const Samples& a = one.advance(at(frame).vertices);
    const Samples& b = two.advance(at(frame).surface());
    EXPECT_TRUE(same_bytes(a, b)) << "frame " << frame;
    EXPECT_EQ(a.fade, b.fade);
  }
}

TEST(PopulationOnNewFaces, GivesTheSameBytesOnAnyNumberOfThreads) {
  std::vector<Samples> base;
  for (const int threads : {1, 2, 5}) {
    const Surface first = metaballs(0, 16).surface();
    Population population(first, sample(first, 200), options_of(threads));
    for (int frame = 1; frame <= 12; ++frame) {
      const Samples& samples = population.advance(metaballs(frame, 16).surface());
      if (threads == 1) base.push_back(samples);
      const Samples& expected = base[static_cast<std::size_t>(frame - 1)];
      EXPECT_TRUE(same_bytes(samples, expected)) << threads << " threads, frame " << frame;
      EXPECT_EQ(samples.fade, expected.fade);
    }
  }
}

TEST(PopulationOnNewFaces, VanishesWithItsSurfaceAndComesWithIt) {
  const Shape ball = icosphere(3);
  const Shape other = mapped(ball, [](const Vec3& p) { return Vec3(0.5 * p + Vec3(3, 0, 0)); });
  const Surface both = joined(ball, other).surface();
  Population population(both, sample(both, 500), options_of());
  const auto on_the_other = [](const Samples& samples, double fade) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (samples.positions[k].x() < 2.0) continue;
      EXPECT_EQ(samples.fade[k], fade);
      ++count;
    }
    return count;
  };
  EXPECT_EQ(on_the_other(population.samples(), 1.0), 100u);
  const Samples& alone = population.advance(ball.surface());
  EXPECT_NEAR(static_cast<double>(alone.report.count), 400.0, 1.0);
  EXPECT_GE(alone.report.deaths, 100u);
  EXPECT_EQ(on_the_other(alone, 0.0), 0u);  // no surface is left for them to fade on
  const Samples& again = population.advance(both);
  EXPECT_NEAR(static_cast<double>(again.report.count), 500.0, 1.0);
  EXPECT_NEAR(static_cast<double>(on_the_other(again, 0.0)), 100.0, 1.0);
}

TEST(PopulationOnNewFaces, FollowsANewDensity) {
  const Shape shape = icosphere(4);
  Population population(shape.surface(), sample(shape.surface(), 400), options_of());
  const Surface half =
      with_face_density(shape, [](const Vec3& p) { return p.z() > 0.0 ? 1.0 : 0.5; }).surface();
  const Samples& samples = population.advance(half);
  EXPECT_NEAR(static_cast<double>(samples.report.count), 300.0, 1.0);
}

TEST(PopulationOnNewFaces, IsUnchangedIfItIsCancelled) {
  const Surface first = metaballs(0, 16).surface();
  Population population(first, sample(first, 200), options_of());
  const Samples before = population.samples();
  Context context;
  context.cancel();
  EXPECT_THROW(population.advance(metaballs(12, 16).surface(), &context), Cancelled);
  EXPECT_TRUE(same_bytes(population.samples(), before));
}

TEST(PopulationOnNewFaces, RefusesToGrowWithoutBound) {
  const Surface first = icosphere(2).surface();
  Population population(first, sample(first, 20), options_of());
  const Surface huge = mapped(icosphere(3), [](const Vec3& p) { return Vec3(1e4 * p); }).surface();
  expect_message<ArgumentError>([&] { population.advance(huge); }, {"20", "samples", "100000000"});
}

}  // namespace
}  // namespace dapple::test
