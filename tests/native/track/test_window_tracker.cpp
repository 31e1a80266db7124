// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/window_tracker.hpp>
#include <iostream>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

WindowOptions with_classes(std::vector<SampleClass> classes) {
  WindowOptions options;
  options.tracker.classes = std::move(classes);
  return options;
}

using Frames = std::vector<std::vector<Vec3>>;

constexpr std::size_t kPiece = 16, kOverlap = 6;

/// A wave over the body with a period of 24 frames.
Frames motion(const Shape& shape, int count) {
  Frames frames;
  for (int frame = 1; frame <= count; ++frame) {
    const double phase = 2.0 * std::numbers::pi * frame / 24.0;
    frames.push_back(mapped(shape, [phase](const Vec3& p) {
                       const double wave = std::sin(2.0 * p.x() - phase) - std::sin(2.0 * p.x());
                       return Vec3(p.x() + 0.1 * wave, p.y() * (1.0 + 0.12 * wave), p.z());
                     }).vertices);
  }
  return frames;
}

/// The samples of all frames after the first, piece by piece.
std::vector<Samples> in_pieces(WindowTracker& tracker, const Frames& frames,
                               std::size_t piece = kPiece, std::size_t overlap = kOverlap) {
  std::vector<Samples> result;
  const std::size_t step = piece - overlap;
  for (std::size_t at = 0; at < frames.size();) {
    const bool last = frames.size() - at < piece + step;
    const std::size_t length = last ? frames.size() - at : piece;
    const std::size_t done = last ? length : step;
    const std::vector<Samples> found = tracker.advance(std::span(frames).subspan(at, length), done);
    result.insert(result.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(done));
    at += done;
  }
  return result;
}

/// Changes of the slide from frame to frame, in spacings: the mean over the samples, per frame from
/// the second on.
std::vector<double> jerks(const Surface& first, const Samples& start, const Frames& frames,
                          const std::vector<Samples>& samples) {
  std::vector<double> result;
  std::vector<Vec3> last;
  for (std::size_t t = 0; t < samples.size(); ++t) {
    const Surface here = first.deformed(frames[t]);
    const Samples& before = t == 0 ? start : samples[t - 1];
    std::vector<Vec3> slides;
    double sum = 0.0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const Vec3 carried = here.point(before.faces[k], before.barycentric[k]);
      slides.push_back(samples[t].positions[k] - carried);
      if (!last.empty()) sum += (slides[k] - last[k]).norm();
    }
    const auto count = static_cast<double>(before.size());
    if (!last.empty()) result.push_back(sum / count / here.spacing(before.size()));
    last = std::move(slides);
  }
  return result;
}

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST(WindowTracker, MovesAsSmoothlyWherePiecesMeetAsElsewhere) {
  const Shape shape = blob(4);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 300);
  const Frames frames = motion(shape, 48);
  WindowTracker tracker(surface, start);
  const std::vector<Samples> found = in_pieces(tracker, frames);
  ASSERT_EQ(found.size(), frames.size());
  const std::vector<double> all = jerks(surface, start, frames, found);
  std::vector<double> seams;
  for (std::size_t at = kPiece - kOverlap; at + kPiece <= frames.size(); at += kPiece - kOverlap)
    for (std::size_t k = at - 2; k <= at + kOverlap; ++k) seams.push_back(all[k]);
  const std::vector<Samples> whole = track_window(surface, start, frames);
  const std::vector<double> at_once =
      jerks(surface, start, frames, std::vector<Samples>(whole.begin() + 1, whole.end()));
  std::cout << "jerk " << mean(all) << ", at seams " << mean(seams) << ", worst "
            << *std::max_element(all.begin(), all.end()) << ", at seams "
            << *std::max_element(seams.begin(), seams.end()) << ", at once " << mean(at_once)
            << ", worst " << *std::max_element(at_once.begin(), at_once.end()) << '\n';
  EXPECT_LE(mean(seams), 1.1 * mean(all));
  EXPECT_LE(mean(all), 1.1 * mean(at_once));
  for (std::size_t t = 0; t < found.size(); ++t) {
    check(surface.deformed(frames[t]), found[t]);
    EXPECT_LE(found[t].report.evenness.capacity_variation, 0.01) << "frame " << t;
    EXPECT_LE(found[t].report.slide_max, 0.5) << "frame " << t;
  }
}

TEST(WindowTracker, IsAWindowWhereOnePieceIsAll) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 100);
  const Frames frames = motion(shape, 8);
  for (const bool closed : {false, true}) {
    const WindowOptions options{.closed = closed};
    const std::vector<Samples> whole = track_window(surface, start, frames, options);
    const std::vector<Samples> found =
        WindowTracker(surface, start, options).advance(frames, frames.size());
    for (std::size_t t = 0; t < found.size(); ++t)
      EXPECT_TRUE(same_bytes(found[t].positions, whole[t + 1].positions));
  }
}

TEST(WindowTracker, ClosesALoopWithTheLastPiece) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  Frames frames = motion(shape, 47);  // the next frame would equal the first
  const auto way_back = [&](std::uint64_t seed, bool closed) {
    SampleOptions options;
    options.seed = seed;
    const Samples start = sample(surface, 100, options);
    WindowTracker tracker(surface, start, {.closed = closed});
    const Samples last = in_pieces(tracker, frames).back();
    double sum = 0.0;
    for (std::size_t k = 0; k < last.size(); ++k)
      sum += (surface.point(last.faces[k], last.barycentric[k]) - start.positions[k]).norm();
    return sum / static_cast<double>(last.size()) / surface.spacing(last.size());
  };
  double open = 0.0, closed = 0.0;  // over several starts, as little moves on its way back
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    open += way_back(seed, false) / 5.0;
    closed += way_back(seed, true) / 5.0;
  }
  std::cout << "seam " << open << " -> " << closed << '\n';
  EXPECT_LT(closed, 0.5 * open);
}

TEST(WindowTracker, KeepsEveryByteWhereNothingMoves) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 100);
  const Frames still(40, shape.vertices);
  WindowTracker tracker(surface, start);
  for (const Samples& one : in_pieces(tracker, still))
    EXPECT_TRUE(same_bytes(one.positions, start.positions));
}

TEST(WindowTracker, GoesOnFromStoredFramesWithTheSameBytes) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const std::vector<SampleClass> classes = {{.count = 60}, {.count = 40}};
  const Samples start = sample_classes(surface, classes);
  const Frames frames = motion(shape, 24);
  const std::span<const std::vector<Vec3>> all(frames);
  WindowTracker whole(surface, start, with_classes(classes));
  const std::vector<Samples> first = whole.advance(all.first(12), 8);
  const std::vector<Samples> second = whole.advance(all.subspan(8), 16);
  const auto stored = [&](std::size_t t) {
    return bind_samples(surface, first[t].faces, first[t].barycentric);
  };
  WindowTracker again(surface, start, with_classes(classes));
  again.resume(frames[7], stored(7), {stored(8), stored(9), stored(10), stored(11)});
  const std::vector<Samples> found = again.advance(all.subspan(8), 16);
  for (std::size_t t = 0; t < found.size(); ++t) {
    EXPECT_TRUE(same_bytes(found[t].positions, second[t].positions));
    EXPECT_EQ(found[t].classes, start.classes);
  }
}

TEST(WindowTracker, GivesTheSameBytesForAnyNumberOfThreads) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 100);
  const Frames frames = motion(shape, 20);
  WindowOptions options{.closed = true, .sweeps = 1};
  options.tracker.threads = 1;
  WindowTracker one(surface, start, options);
  options.tracker.threads = 4;
  WindowTracker four(surface, start, options);
  const std::vector<Samples> slow = in_pieces(one, frames, 8, 3);
  const std::vector<Samples> fast = in_pieces(four, frames, 8, 3);
  for (std::size_t t = 0; t < frames.size(); ++t)
    EXPECT_TRUE(same_bytes(slow[t].positions, fast[t].positions));
}

TEST(WindowTracker, IsUnchangedWhenItIsCancelled) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 50);
  const Frames frames = motion(shape, 4);
  WindowTracker tracker(surface, start);
  Context context;
  context.cancel();
  EXPECT_THROW((void)tracker.advance(frames, 2, &context), Cancelled);
  EXPECT_TRUE(same_bytes(tracker.samples().positions, start.positions));
  EXPECT_TRUE(tracker.ahead().empty());
  EXPECT_EQ(tracker.advance(frames, 2).size(), 4u);
  EXPECT_EQ(tracker.ahead().size(), 2u);
}

TEST(WindowTracker, NamesWhatDoesNotFit) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  const Samples start = sample(surface, 50);
  Frames frames = motion(shape, 6);
  WindowTracker tracker(surface, start);
  expect_message<ArgumentError>([&] { (void)tracker.advance(frames, 7); }, {"done", "7"});
  (void)tracker.advance(frames, 1);
  expect_message<ArgumentError>([&] { (void)tracker.advance(std::span(frames).first(4), 4); },
                                {"frames", "5"});
  expect_message<ArgumentError>(
      [&] {
        tracker.resume(frames[0], start, {start, sample(icosphere(5).surface(), start.size())});
      },
      {"ahead[1].faces[", "outside the surface's faces"});
  expect_message<ArgumentError>([&] { tracker.resume(frames[0], start, {sample(surface, 49)}); },
                                {"ahead", "49"});
  expect_message<ArgumentError>([&] { (void)WindowTracker(surface, start, {.sweeps = -1}); },
                                {"sweeps", "-1"});
  frames[3].pop_back();
  EXPECT_THROW((void)tracker.advance(std::span(frames).subspan(1), 5), SurfaceError);
}

}  // namespace
}  // namespace dapple::test
