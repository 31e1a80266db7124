// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/window.hpp>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "track/solve_window.hpp"

namespace dapple {

std::vector<Samples> track_window(const Surface& surface, std::span<const std::vector<Vec3>> frames,
                                  const Samples& samples, const WindowOptions& options,
                                  std::vector<SampleClass> classes, Context* context) {
  check_options(options);
  check_frames(surface, frames);
  std::vector<Samples> result = with_threads(options.tracker.threads, [&] {
    const MotionStart start(surface, samples, options, std::move(classes), context);
    return solve_window(start, start.tracker, frames, {}, options.closed, context);
  });
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
