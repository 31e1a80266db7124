// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"
#include "tracked_body.hpp"

namespace dapple::test {
namespace {

TEST(Tracker, GoesOnFromAStoredFrameWithTheSameBytes) {
  const Shape shape = body();
  const Surface surface = shape.surface();
  const Samples first = sample(surface, kCount);
  Tracker whole(surface, first);
  constexpr int kPeriod = 30;
  Samples stored;
  bool settled = false;
  for (int frame = 1; frame <= 9; ++frame) {
    whole.advance(pull(shape, frame, kPeriod));
    if (frame != 6) continue;
    stored = bind_samples(whole.surface(), whole.samples().faces, whole.samples().barycentric);
    settled = whole.settled();
  }
  Tracker resumed(surface, first);
  resumed.resume(pull(shape, 6, kPeriod), stored, settled);
  for (int frame = 7; frame <= 9; ++frame) resumed.advance(pull(shape, frame, kPeriod));
  EXPECT_TRUE(same_bytes(resumed.samples(), whole.samples()));
}

/// A plate with a disc without density that enters from the left.
Surface plate_with_hole(const Shape& plate, double x) {
  std::vector<double> density;
  for (const Vec3& p : plate.vertices)
    density.push_back((p - Vec3(x, 0.5, 0.0)).norm() < 0.2 ? 0.0 : 1.0);
  return plate.surface().with_density({DensityAt::kVertices, density});
}

TEST(Tracker, GoesOnUnderADensityThatMoves) {
  const Shape plate = grid(40);
  const Surface begin = plate_with_hole(plate, 0.2);
  Tracker tracker(begin, sample(begin, kCount));
  const Samples first = tracker.samples();
  for (int frame = 1; frame <= 10; ++frame) {
    const Surface next = plate_with_hole(plate, 0.2 + 0.03 * frame);
    tracker.resume_on(next, plate.vertices, tracker.samples(), first);
    const Samples& now = tracker.advance(plate.vertices);
    ASSERT_EQ(now.ids, first.ids);
    for (std::size_t k = 0; k < now.size(); ++k) {
      const auto face = plate.faces[static_cast<std::size_t>(now.faces[k])];
      const std::vector<double> density = next.density();
      double at = 0.0;
      for (int c = 0; c < 3; ++c)
        at += now.barycentric[k][c] * density[static_cast<std::size_t>(face[c])];
      EXPECT_GT(at, 0.0) << frame << ' ' << k;
    }
    EXPECT_LT(now.report.evenness.capacity_variation, 0.2) << frame;
    EXPECT_GT(now.report.evenness.alpha_min, 0.3) << frame;
  }
}

TEST(Tracker, RefusesToGoOnWithSamplesOfAnotherNumber) {
  const Shape shape = icosphere(2);
  Tracker tracker = tracker_of(shape, 50);
  const Samples before = tracker.samples();
  const Samples fewer = sample(shape.surface(), 49);
  EXPECT_THROW(tracker.resume_on(shape.surface(), shape.vertices, fewer, before), ArgumentError);
  EXPECT_THROW(tracker.resume_on(shape.surface(), shape.vertices, before, fewer), ArgumentError);
  EXPECT_THROW(tracker.resume_on(shape.surface(), shape.vertices, before, before, {{}, {}}),
               ArgumentError);
  expect_untouched(tracker, before, shape.vertices);
}

TEST(Tracker, RefusesToResumeFromAnotherNumber) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const Samples few = sample(shape.surface(), 10);
  expect_message<ArgumentError>([&] { tracker.resume(shape.vertices, few, true); },
                                {"samples", "10", "400"});
}

TEST(Tracker, RefusesToResumeFromAnotherSurface) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const std::vector<Vec3> next = deformed(shape.vertices, 0.3);
  tracker.advance(next);
  const Samples before = tracker.samples();
  const Surface large = icosphere(5).surface(), small = icosphere(2).surface();
  expect_message<ArgumentError>(
      [&] { tracker.resume(shape.vertices, sample(large, before.size()), true); },
      {"samples.faces[", "outside the surface's faces"});
  expect_message<ArgumentError>(
      [&] { tracker.resume(shape.vertices, sample(small, before.size()), true); },
      {"samples.positions[0] is ", "away from", "another surface"});
  EXPECT_TRUE(same_bytes(tracker.samples(), before));
  EXPECT_THROW(Tracker(shape.surface(), sample(small, 40)), ArgumentError);
}

TEST(Tracker, ResumesFromPlacesOnAnyFrameItKnows) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const Surface first = tracker.surface();
  const std::vector<Vec3> one = deformed(shape.vertices, 0.3), two = deformed(shape.vertices, 0.6);
  tracker.advance(one);
  const Samples kept = tracker.samples();
  tracker.advance(two);
  for (const Surface& frame : {first, first.deformed(one), first.deformed(two)}) {
    Tracker again = tracker;
    again.resume(one, bind_samples(frame, kept.faces, kept.barycentric), true);
    EXPECT_TRUE(same_bytes(again.samples().positions, kept.positions));
  }
}

}  // namespace
}  // namespace dapple::test
