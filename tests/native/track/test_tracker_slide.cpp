// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/tracker.hpp>
#include <iostream>

#include "shapes.hpp"
#include "tracked_body.hpp"

namespace dapple::test {
namespace {

/// The mean distance from the start after several loops, in spacings.
double hysteresis(double pattern_strength) {
  const Shape shape = blob(4);
  Tracker tracker = tracker_of(shape, kCount, {.pattern_strength = pattern_strength});
  const std::vector<Vec3> start = tracker.samples().positions;
  constexpr int kPeriod = 30;
  for (int frame = 1; frame <= 5 * kPeriod; ++frame) tracker.advance(pull(shape, frame, kPeriod));
  double sum = 0.0;
  for (std::size_t k = 0; k < kCount; ++k)
    sum += (tracker.samples().positions[k] - start[k]).norm();
  return sum / static_cast<double>(kCount) / tracker.surface().spacing(kCount);
}

TEST(Tracker, ReturnsToTheFirstPatternAfterLoops) {
  const double with = hysteresis(0.8);
  const double without = hysteresis(0.0);
  std::cout << "after five loops " << with << " spacings from the start, without memory " << without
            << '\n';
  EXPECT_LT(with, 0.75 * without);
}

TEST(Tracker, StickinessTradesSlideForEvenness) {
  const Shape shape = body();
  double last_slide = 1.0, last_variation = 0.0;
  for (const double stickiness : {0.0, 3.0, 100.0}) {
    TrackerOptions options{.pattern_strength = 0.0};
    options.optimizer.stickiness = stickiness;
    Tracker tracker = tracker_of(shape, kCount, options);
    double slide = 0.0, variation = 0.0;
    for (int frame = 1; frame <= 10; ++frame) {
      const Report& report = tracker.advance(deformed(shape.vertices, 0.15 * frame)).report;
      slide += report.slide_mean / 10.0;
      variation += report.evenness.capacity_variation / 10.0;
    }
    EXPECT_LT(slide, last_slide) << "stickiness " << stickiness;
    EXPECT_GT(variation, last_variation) << "stickiness " << stickiness;
    last_slide = slide;
    last_variation = variation;
  }
}

struct Calmness {
  double jerk = 0.0;       // mean change of the slide from frame to frame, in spacings
  double variation = 0.0;  // of the capacities, mean
};

/// On a body that is stretched.
Calmness calmness(double smoothing) {
  const Shape shape = blob(4);
  TrackerOptions options;
  options.optimizer.slide_smoothing = smoothing;
  Tracker tracker = tracker_of(shape, kCount, options);
  std::vector<Vec3> last(kCount, Vec3::Zero());
  Calmness found;
  constexpr int kFrames = 20;
  for (int frame = 1; frame <= kFrames; ++frame) {
    const Samples before = tracker.samples();
    const std::vector<Vec3> vertices = pull(shape, frame, 60);
    const Samples& now = tracker.advance(vertices);
    for (std::size_t k = 0; k < kCount; ++k) {
      const Vec3 slide =
          now.positions[k] - tracker.surface().point(before.faces[k], before.barycentric[k]);
      if (frame > 1) found.jerk += (slide - last[k]).norm();
      last[k] = slide;
    }
    found.variation += now.report.evenness.capacity_variation / kFrames;
  }
  found.jerk /= tracker.surface().spacing(kCount) * kCount * (kFrames - 1);
  return found;
}

TEST(Tracker, SlideSmoothingIsCalmerAndAsEven) {
  const Calmness with = calmness(0.15);
  const Calmness without = calmness(0.0);
  std::cout << "jerk " << with.jerk << " and without " << without.jerk << ", variation "
            << with.variation << " and " << without.variation << '\n';
  EXPECT_LT(with.jerk, 0.95 * without.jerk);
  EXPECT_LT(with.variation, 1.25 * without.variation);
}

}  // namespace
}  // namespace dapple::test
