// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>
#include <dapple/window_options.hpp>

namespace dapple {

/// Samples on all frames of a motion at once, smooth both ways in time.
///
/// After a pass of a Tracker, sweeps go forwards and backwards over the frames, each minimized with
/// the others fixed: block coordinate descent on the sum over the frames of what a Tracker
/// restores, and of gamma sum_k m_k |x_k(t) - carried x_k(t-1)|^2. So a sample is drawn to the
/// middle between where the surface carries it from the frame before and from the one after. The
/// first frame stays. In a closed motion what is left between the last frame and the first is
/// spread over all frames before, so that the loop closes.
/// \param surface of the first frame
/// \param frames the vertices of the frames after it
/// \param samples on the first frame
/// \param classes as a Tracker takes them
/// \return samples of the first frame and of all frames after it; their reports' slides are
///         distances from where the surface carries the samples of the frame before
/// \throw SurfaceError naming the frame's first offender, ArgumentError, Cancelled
[[nodiscard]] std::vector<Samples> track_window(const Surface& surface,
                                                std::span<const std::vector<Vec3>> frames,
                                                const Samples& samples,
                                                const WindowOptions& options = {},
                                                std::vector<SampleClass> classes = {},
                                                Context* context = nullptr);

}  // namespace dapple
