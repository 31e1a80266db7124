// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/window_tracker.hpp>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "sample/validate_samples.hpp"
#include "surface/validate_surface.hpp"
#include "track/solve_window.hpp"

namespace dapple {
namespace {

std::shared_ptr<const MotionStart> started(const Surface& surface, const Samples& samples,
                                           const WindowOptions& options, Context* context) {
  check_options(options);
  return with_threads(options.tracker.threads, [&] {
    return std::make_shared<const MotionStart>(surface, samples, options, context);
  });
}

void check_counts(std::size_t frames, std::size_t ahead, std::size_t done) {
  const auto refuse = [&](const std::string& what) {
    throw ArgumentError("frames has " + std::to_string(frames) + " entries, but " + what);
  };
  if (frames < ahead) refuse(std::to_string(ahead) + " frames are ahead");
  if (frames < done) refuse("done is " + std::to_string(done));
}

}  // namespace

std::vector<Samples> track_window(const Surface& surface, const Samples& samples,
                                  std::span<const std::vector<Vec3>> frames,
                                  const WindowOptions& options, Context* context) {
  check_options(options);
  check_frames(surface, frames);
  std::vector<Samples> result = with_threads(options.tracker.threads, [&] {
    const MotionStart start(surface, samples, options, context);
    return solve_window(start, start.tracker, frames, {}, options.closed, context);
  });
  if (context) context->advance(1.0);
  return result;
}

WindowTracker::WindowTracker(const Surface& surface, const Samples& samples,
                             const WindowOptions& options, Context* context)
    : start_(started(surface, samples, options, context)), present_(start_->tracker) {
  if (context) context->advance(1.0);
}

std::vector<Samples> WindowTracker::advance(std::span<const std::vector<Vec3>> frames,
                                            std::size_t done, Context* context) {
  check_counts(frames.size(), ahead_.size(), done);
  check_frames(surface(), frames);
  const bool closing = start_->options.closed && done == frames.size();
  std::vector<Samples> found = with_threads(start_->options.tracker.threads, [&] {
    return solve_window(*start_, present_, frames, ahead_, closing, context);
  });
  found.erase(found.begin());  // the current frame's samples
  if (done > 0) present_.resume(frames[done - 1], found[done - 1], false);
  ahead_.assign(found.begin() + static_cast<std::ptrdiff_t>(done), found.end());
  if (context) context->advance(1.0);
  return found;
}

void WindowTracker::resume(std::span<const Vec3> vertices, const Samples& samples,
                           std::vector<Samples> ahead) {
  for (std::size_t k = 0; k < ahead.size(); ++k) {
    const std::string owner = entry("ahead", k);
    check_same_length(owner.c_str(), ahead[k].size(), "the tracker's samples",
                      this->samples().size());
    check_lengths(ahead[k], owner);
    check_binding(owner, surface(), ahead[k].faces, ahead[k].barycentric);
  }
  present_.resume(vertices, samples, false);
  ahead_ = std::move(ahead);
}

}  // namespace dapple
