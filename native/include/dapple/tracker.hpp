// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/classes.hpp>
#include <memory>

namespace dapple {

class FrameSolver;

struct TrackerOptions {
  double union_weight = 1.0;  ///< mu, of samples of several classes; see ClassOptions

  /// Within one frame no sample slides by half a spacing: after a violent frame evenness is caught
  /// up over the next ones, instead of by a jump.
  OptimizerOptions optimizer = {.max_evaluations = 6, .max_slide = 0.45};
  Cells cells = Cells::kConnected;
  /// Farthest that the surface's shape may move at once, relative to its size, apart from moving as
  /// a whole, scaling and mirroring; a frame on which it moves farther is split into parts. 0:
  /// never.
  double longest_motion = 0.02;
  double memory = 0.8;  ///< 0..1: how strongly samples return to the first frame's pattern
  int threads = 0;      ///< 0: as many as the machine has; the result does not depend on it
};

/// Carries samples over a deforming surface: they ride the moved vertices by their barycentric
/// coordinates and are then re-optimised, each keeping its index and id (paper, section 5.4).
///
/// A frame is restored to the evenness of the first one, not minimised on: minimising on every
/// frame would turn the samples into a hexagonal pattern, and samples that need not move should
/// not.
class Tracker {
 public:
  /// \param classes densities and radii of the samples' classes (counts are the samples'); empty:
  ///                 one class, whatever the samples say
  /// \throw ArgumentError if the samples are not of the surface or the classes; see
  /// sample_classes()
  Tracker(Surface surface, Samples samples, TrackerOptions options = {},
          std::vector<SampleClass> classes = {});

  /// Move to the next frame. The tracker is unchanged if this throws.
  /// \param vertices as many as the surface has, in the caller's order
  /// \throw SurfaceError, Cancelled
  const Samples& advance(std::span<const Vec3> vertices, Context* context = nullptr);

  /// Go on from a frame that was solved before, as if this tracker had solved it.
  /// \param samples the frame's faces and barycentric coordinates, as many as the tracker has
  /// \param settled what settled() said then
  /// \throw SurfaceError, ArgumentError
  void resume(std::span<const Vec3> vertices, const Samples& samples, bool settled);

  /// Whether nothing was left to be caught up when the last frame was done.
  [[nodiscard]] bool settled() const { return settled_; }
  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Samples& samples() const { return samples_; }

 private:
  friend class Population;
  void exchange(const Samples& samples);

  Surface surface_;
  Samples samples_;
  std::shared_ptr<const FrameSolver> solver_;
  bool settled_ = true;  // the first frame is what the others are held against
};

}  // namespace dapple
