// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/window_tracker.hpp>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "track/solve_window.hpp"

namespace dapple {

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

}  // namespace dapple
