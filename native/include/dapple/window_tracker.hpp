// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/window.hpp>

namespace dapple {

struct MotionStart;

/// Samples on a long motion, as smooth both ways in time as track_window() makes them, some frames
/// at a time.
///
/// Pieces of the motion overlap: the last frames of each are solved again with the piece after it,
/// over which what was found first passes into what is found then. So motion is as smooth at the
/// seams as elsewhere, and no more than one piece has to be in memory.
class WindowTracker {
 public:
  /// \param surface of the first frame
  /// \param samples on it; they stay
  /// \param classes as a Tracker takes them
  /// \throw ArgumentError if the samples are not of the surface or the classes; Cancelled
  WindowTracker(const Surface& surface, const Samples& samples, const WindowOptions& options = {},
                std::vector<SampleClass> classes = {}, Context* context = nullptr);

  /// Solve the frames after the present one. The tracker is unchanged if this throws.
  /// \param frames vertices of each; first of those that were ahead so far
  /// \param done how many of them are done then: the last of these becomes the present frame, the
  ///             others are ahead. If all are, the motion ends there, and a closed one leads back
  ///             to its first frame.
  /// \return samples of all these frames, as track_window() returns them
  /// \throw SurfaceError naming the frame's first offender; ArgumentError for fewer frames than are
  /// ahead or done; Cancelled
  std::vector<Samples> advance(std::span<const std::vector<Vec3>> frames, std::size_t done,
                               Context* context = nullptr);

  /// Go on from frames that were solved before, as if this tracker had solved them.
  /// \param vertices of the present frame
  /// \param samples the present frame's faces and barycentric coordinates
  /// \param ahead those of the frames ahead
  /// \throw SurfaceError, ArgumentError
  void resume(std::span<const Vec3> vertices, const Samples& samples, std::vector<Samples> ahead);

  [[nodiscard]] const Surface& surface() const { return present_.surface(); }
  [[nodiscard]] const Samples& samples() const { return present_.samples(); }
  /// Samples of the frames that are to be solved again.
  [[nodiscard]] const std::vector<Samples>& ahead() const { return ahead_; }

 private:
  std::shared_ptr<const MotionStart> start_;
  Tracker present_;
  std::vector<Samples> ahead_;
};

}  // namespace dapple
