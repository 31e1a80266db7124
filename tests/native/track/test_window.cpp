// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/window_tracker.hpp>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 300;
constexpr int kPeriod = 16;

WindowOptions with_classes(std::vector<SampleClass> classes, WindowOptions options = {}) {
  options.tracker.classes = std::move(classes);
  return options;
}

/// A loop of frames 1 .. kPeriod - 1; the next frame would equal the shape.
std::vector<std::vector<Vec3>> loop(const Shape& shape) {
  std::vector<std::vector<Vec3>> frames;
  for (int frame = 1; frame < kPeriod; ++frame) {
    const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * frame / kPeriod);
    frames.push_back(mapped(shape, [share](const Vec3& p) {
                       const double along = std::exp(-8.0 * p.x() * p.x());
                       return Vec3(p.x() + 0.4 * share * std::tanh(3.0 * p.x()),
                                   p.y() * (1.0 + 0.2 * share * along), p.z());
                     }).vertices);
  }
  return frames;
}

/// Mean distances, in spacings, from where the surface carries the samples of the frame before, and
/// of their changes from frame to frame.
struct Smoothness {
  double seam = 0.0;  // from the last frame to the first
  // from the first frame to the second: the same distance, because the motion is symmetric
  double first = 0.0;
  double slide = 0.0;  // the mean over all frames
  double jerk = 0.0;
};

Smoothness measure(const Surface& first, const std::vector<std::vector<Vec3>>& frames,
                   const std::vector<Samples>& samples) {
  const auto surface = [&](std::size_t t) {
    return t == 0 ? first : first.deformed(frames[t - 1]);
  };
  const double spacing = first.spacing(kCount);
  Smoothness result;
  std::vector<Vec3> last;
  for (std::size_t t = 1; t <= samples.size(); ++t) {
    const Samples& now = samples[t % samples.size()];
    const Surface here = surface(t % samples.size());
    std::vector<Vec3> slides;
    double sum = 0.0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const Vec3 carried = here.point(samples[t - 1].faces[k], samples[t - 1].barycentric[k]);
      slides.push_back(now.positions[k] - carried);
      sum += slides[k].norm();
      if (!last.empty()) result.jerk += (slides[k] - last[k]).norm();
    }
    if (t == 1) result.first = sum / kCount / spacing;
    if (t == samples.size()) result.seam = sum / kCount / spacing;
    result.slide += sum / kCount / spacing / static_cast<double>(samples.size());
    last = std::move(slides);
  }
  result.jerk /= kCount * spacing * static_cast<double>(samples.size() - 1);
  return result;
}

TEST(Window, EvaluatesNothingWhereNothingMoves) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const Samples first = sample(surface, kCount);
  const std::vector<std::vector<Vec3>> still(5, shape.vertices);
  const std::vector<Samples> found = track_window(surface, first, still);
  for (const Samples& samples : found) EXPECT_TRUE(same_bytes(samples.positions, first.positions));
  for (std::size_t t = 1; t < found.size(); ++t) {
    EXPECT_EQ(found[t].report.evaluations, 0) << "frame " << t;
    EXPECT_EQ(found[t].report.energy, first.report.energy) << "frame " << t;
    EXPECT_EQ(found[t].report.slide_max, 0.0) << "frame " << t;
  }
}

TEST(TrackWindow, SmoothsBothWaysAndClosesALoop) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, kCount);
  const std::vector<std::vector<Vec3>> frames = loop(shape);
  const WindowOptions tracked{.sweeps = 0};
  const std::vector<Samples> plain = track_window(surface, start, frames, tracked);
  const std::vector<Samples> smooth =
      track_window(surface, start, frames, {.closed = true, .sweeps = 4});
  ASSERT_EQ(smooth.size(), static_cast<std::size_t>(kPeriod));
  EXPECT_TRUE(same_bytes(smooth[0].positions, start.positions));
  double worst = 0.0;
  check(surface, smooth[0]);
  for (std::size_t t = 1; t < smooth.size(); ++t) {
    check(surface.deformed(frames[t - 1]), smooth[t]);
    worst = std::max(worst, smooth[t].report.evenness.capacity_variation);
    EXPECT_LE(smooth[t].report.slide_max, 0.5);
  }
  const Smoothness before = measure(surface, frames, plain);
  const Smoothness after = measure(surface, frames, smooth);
  std::cout << "first " << before.first << " -> " << after.first << ", seam " << before.seam
            << " -> " << after.seam << ", jerk " << before.jerk << " -> " << after.jerk
            << ", slide " << before.slide << " -> " << after.slide << ", spread " << worst << '\n';
  EXPECT_LE(worst, 0.01);
  EXPECT_LT(after.seam, 1.3 * after.first) << "the seam stands out";
  EXPECT_GT(before.seam, 1.3 * before.first) << "there was nothing to close";
  EXPECT_LT(after.slide, before.slide);
  EXPECT_LT(after.jerk, 0.9 * before.jerk);
}

TEST(TrackWindow, WithoutSweepsIsATracker) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 100);
  const std::vector<std::vector<Vec3>> frames = loop(shape);
  const std::vector<Samples> found = track_window(surface, start, frames, {.sweeps = 0});
  Tracker tracker(surface, start);
  for (std::size_t t = 1; t < found.size(); ++t)
    EXPECT_TRUE(same_bytes(tracker.advance(frames[t - 1]).positions, found[t].positions));
}

TEST(TrackWindow, WithoutSweepsIsATrackerOfClassesToo) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const std::vector<SampleClass> classes = {{.count = 60}, {.count = 40}};
  const Samples start = sample_classes(surface, classes);
  const std::vector<std::vector<Vec3>> frames = loop(shape);
  const std::vector<Samples> found =
      track_window(surface, start, frames, with_classes(classes, {.sweeps = 0}));
  Tracker tracker(surface, start, {.classes = classes});
  for (std::size_t t = 1; t < found.size(); ++t)
    EXPECT_TRUE(same_bytes(tracker.advance(frames[t - 1]).positions, found[t].positions));
}

Samples of_class(const Surface& surface, const Samples& samples, std::int32_t one) {
  std::vector<std::int32_t> faces;
  std::vector<Vec3> barycentric;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples.classes[k] != one) continue;
    faces.push_back(samples.faces[k]);
    barycentric.push_back(samples.barycentric[k]);
  }
  return bind_samples(surface, faces, barycentric);
}

/// The largest variation of the areas of one class, over all frames after the first.
double worst_of_class(const Surface& first, const std::vector<std::vector<Vec3>>& frames,
                      const std::vector<Samples>& samples, std::int32_t one) {
  double worst = 0.0;
  for (std::size_t t = 1; t < samples.size(); ++t) {
    const Surface here = first.deformed(frames[t - 1]);
    const Report report = analyze(here, of_class(here, samples[t], one));
    worst = std::max(worst, report.evenness.capacity_variation);
  }
  return worst;
}

TEST(TrackWindow, KeepsEachClassEven) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const std::vector<SampleClass> classes = {{.count = 200}, {.count = 100}};
  const Samples start = sample_classes(surface, classes);
  const std::vector<std::vector<Vec3>> frames = loop(shape);
  const std::vector<Samples> apart =
      track_window(surface, start, frames, with_classes(classes, {.closed = true}));
  const std::vector<Samples> as_one = track_window(surface, start, frames, {.closed = true});
  EXPECT_EQ(apart.back().classes, start.classes);
  for (const std::int32_t one : {0, 1}) {
    const double worst = worst_of_class(surface, frames, apart, one);
    std::cout << "class " << one << ": " << worst << '\n';
    EXPECT_LE(worst, 0.05);
    EXPECT_GT(worst_of_class(surface, frames, as_one, one), worst);
  }
}

TEST(TrackWindow, RefusesAClassThatIsNotGiven) {
  const Surface surface = blob(3).surface();
  const std::vector<SampleClass> classes = {{.count = 30}, {.count = 20}};
  const Samples start = sample_classes(surface, classes);
  expect_message<ArgumentError>(
      [&] { (void)track_window(surface, start, {}, with_classes({{.count = 50}})); },
      {"samples.classes", "1"});
}

TEST(TrackWindow, GivesTheSameBytesForAnyNumberOfThreads) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const std::vector<SampleClass> classes = {{.count = 60}, {.count = 40}};
  const Samples start = sample_classes(surface, classes);
  WindowOptions options{.closed = true, .sweeps = 1};
  options.tracker.threads = 1;
  const std::vector<Samples> one =
      track_window(surface, start, loop(shape), with_classes(classes, options));
  options.tracker.threads = 4;
  const std::vector<Samples> four =
      track_window(surface, start, loop(shape), with_classes(classes, options));
  for (std::size_t t = 0; t < one.size(); ++t)
    EXPECT_TRUE(same_bytes(one[t].positions, four[t].positions));
}

TEST(TrackWindow, TakesNoSampleAtAll) {
  const Surface surface = icosphere(1).surface();
  const std::vector<std::vector<Vec3>> frames = {deformed(surface.vertices(), 0.2)};
  for (const Samples& samples : track_window(surface, Samples{}, frames, {}))
    EXPECT_EQ(samples.size(), 0u);
}

TEST(TrackWindow, StopsWhenCancelled) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  Context context;
  context.cancel();
  EXPECT_THROW((void)track_window(surface, sample(surface, 50), loop(shape), {}, &context),
               Cancelled);
}

TEST(TrackWindow, NamesWhatIsOutOfRange) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 50);
  expect_message<ArgumentError>(
      [&] { (void)track_window(surface, start, loop(shape), {.sweeps = -1}); }, {"sweeps", "-1"});
  std::vector<std::vector<Vec3>> frames = loop(shape);
  frames[3].pop_back();
  EXPECT_THROW((void)track_window(surface, start, frames), SurfaceError);
}

}  // namespace
}  // namespace dapple::test
