// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>
#include <dapple/window_tracker.hpp>
#include <span>

#include "track/frame_solver.hpp"

namespace dapple {

/// The first frame of a motion, the reference for the evenness of all others.
struct MotionStart {
  /// \throw ArgumentError as Tracker; Cancelled
  MotionStart(const Surface& surface, const Samples& samples, const WindowOptions& options,
              Context* context);

  WindowOptions options;
  Tracker tracker;  ///< there, and without stickiness
  FrameSolver solver;
};

/// \throw SurfaceError naming the first frame that does not belong to the surface
void check_frames(const Surface& surface, std::span<const std::vector<Vec3>> frames);

/// Samples on frames of a motion that are solved together.
/// \param begin a tracker at the frame before them, whose samples stay
/// \param known samples of the first of the frames, from when those were the last ones of others
/// that
///              were solved together: over them, what was found then passes into what is found now
/// \param closing whether the motion's first frame follows the last one
/// \return samples of the frame before them and of all frames
/// \throw Cancelled
[[nodiscard]] std::vector<Samples> solve_window(const MotionStart& start, const Tracker& begin,
                                                std::span<const std::vector<Vec3>> frames,
                                                std::span<const Samples> known, bool closing,
                                                Context* context);

}  // namespace dapple
