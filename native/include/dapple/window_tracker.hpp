// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>

namespace dapple {

struct WindowOptions {
  /// The last frame leads back to the first one, as a closed loop.
  bool closed = false;  // expert
  /// Number of passes forward and backward over all frames, after the first one.
  int sweeps = 2;  // expert, >= 0
  TrackerOptions tracker = {
      .optimizer = {.max_evaluations = 6, .max_slide = 0.45, .stickiness = 1.0}};  // options
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const WindowOptions& options);

/// Samples on all frames of a motion, smooth forward and backward in time.
///
/// After a pass of a Tracker, sweeps go forward and backward over the frames, and each frame is
/// minimized with the others fixed: block coordinate descent on the sum over the frames of the
/// Tracker's objective and of gamma sum_k m_k |x_k(t) - carried x_k(t-1)|^2. A sample is thus drawn
/// to the middle between its positions carried from the frame before and from the frame after. The
/// first frame stays. In a closed motion the difference between the last frame and the first is
/// spread over all frames before, so that the loop closes.
/// \param surface of the first frame
/// \param samples on the first frame
/// \param frames the vertices of the frames after it
/// \return samples of the first frame and of all frames after it; the slides in their reports are
///         distances from the positions carried from the frame before
/// \throw SurfaceError naming the frame's first offender, ArgumentError, Cancelled
[[nodiscard]] std::vector<Samples> track_window(const Surface& surface, const Samples& samples,
                                                std::span<const std::vector<Vec3>> frames,
                                                const WindowOptions& options = {},
                                                Context* context = nullptr);

struct MotionStart;

/// Samples on a long motion, as smooth as those of track_window(), solved some frames at a time.
///
/// Pieces of the motion overlap: the last frames of each piece are solved again with the next
/// piece, and the two results are blended over the overlap. The motion is thus as smooth at the
/// seams as elsewhere, with only one piece in memory.
class WindowTracker {
 public:
  /// \param surface of the first frame
  /// \param samples on it; they do not change
  /// \throw ArgumentError if the samples do not lie on the surface or their classes do not match;
  /// Cancelled
  WindowTracker(const Surface& surface, const Samples& samples, const WindowOptions& options = {},
                Context* context = nullptr);

  /// Solve the frames after the present one. The tracker is unchanged if this throws.
  /// \param frames vertices of each, beginning with the frames that were ahead so far
  /// \param done number of frames that are final: the last of them becomes the present frame, and
  ///             the others stay ahead. If all are final, the motion ends there, and a closed
  ///             motion leads back to its first frame.
  /// \return samples of all these frames, as track_window() returns them
  /// \throw SurfaceError naming the frame's first offender; ArgumentError if there are fewer frames
  /// than are ahead or done; Cancelled
  std::vector<Samples> advance(std::span<const std::vector<Vec3>> frames, std::size_t done,
                               Context* context = nullptr);

  /// Continue from frames that were solved earlier, as if this tracker had solved them.
  /// \param vertices of the present frame
  /// \param samples the present frame's faces and barycentric coordinates
  /// \param ahead samples of the frames ahead
  /// \throw SurfaceError, ArgumentError
  void resume(std::span<const Vec3> vertices, const Samples& samples, std::vector<Samples> ahead);

  [[nodiscard]] const Surface& surface() const { return present_.surface(); }
  [[nodiscard]] const Samples& samples() const { return present_.samples(); }
  /// Samples of the frames that will be solved again.
  [[nodiscard]] const std::vector<Samples>& ahead() const { return ahead_; }

 private:
  std::shared_ptr<const MotionStart> start_;
  Tracker present_;
  std::vector<Samples> ahead_;
};

}  // namespace dapple
