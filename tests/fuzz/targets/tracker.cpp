// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/sampler.hpp>
#include <dapple/window_tracker.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

std::optional<Samples> take_first(Bytes& bytes, const Surface& surface) {
  if (bytes.one_in(4)) return take_samples(bytes, surface);
  const std::size_t count = take_count(bytes, 40);
  return answer([&] { return sample(surface, count, {.optimizer = {.max_evaluations = 5}}); });
}

std::vector<SampleClass> take_classes(Bytes& bytes) {
  std::vector<SampleClass> classes;
  if (bytes.one_in(4)) classes.resize(static_cast<std::size_t>(bytes.between(1, 3)));
  for (SampleClass& one : classes)
    if (bytes.one_in(2)) one.radius = 0.1 * bytes.share();
  return classes;
}

/// The samples of every frame that is not refused; a refused one changes nothing.
std::vector<Samples> tracked(Tracker& tracker, std::span<const std::vector<Vec3>> frames) {
  std::vector<Samples> result;
  for (const std::vector<Vec3>& frame : frames) {
    const Samples before = tracker.samples();
    const auto after = answer([&] { return tracker.advance(frame); });
    if (!after) {
      EXPECT_TRUE(same_bytes(tracker.samples(), before)) << "refused, and changed";
    }
    if (!after) continue;
    expect_valid(tracker.surface(), *after);
    expect_where_dense(tracker.surface(), *after);
    EXPECT_EQ(after->ids, before.ids);
    result.push_back(*after);
  }
  return result;
}

void fuzz_window(const Surface& surface, const Samples& first,
                 std::span<const std::vector<Vec3>> frames, WindowOptions options) {
  const auto all = answer_of_threads([&](int threads) {
    options.tracker.threads = threads;
    return track_window(surface, first, frames, options);
  });
  if (!all) return;
  EXPECT_EQ(all->size(), frames.size() + 1);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    expect_valid(surface.deformed(frames[k]), (*all)[k + 1]);
    expect_where_dense(surface, (*all)[k + 1]);
  }
}

}  // namespace

void fuzz_tracker(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const auto first = take_first(bytes, *surface);
  if (!first) return;
  std::vector<std::vector<Vec3>> frames;
  for (int k = bytes.between(1, 4); k > 0; --k)
    frames.push_back(take_frame(bytes, surface->vertices()));
  if (bytes.one_in(4)) {
    WindowOptions options;
    take_options(bytes, options);
    return fuzz_window(*surface, *first, frames, options);
  }
  TrackerOptions options;
  take_options(bytes, options);
  options.classes = take_classes(bytes);
  (void)answer_of_threads([&](int threads) {
    options.threads = threads;
    Tracker tracker(*surface, *first, options);
    return tracked(tracker, frames);
  });
}

}  // namespace dapple::fuzz
