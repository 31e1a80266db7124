// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/classes.hpp>

namespace dapple {

struct TrackerOptions {
  double union_weight = 1.0;  ///< mu, of samples of several classes; see ClassOptions

  /// Within one frame no sample slides by half a spacing: after a violent frame evenness is caught
  /// up over the next ones, instead of by a jump.
  OptimizerOptions optimizer = {.max_evaluations = 6, .max_slide = 0.45};
  Cells cells = Cells::kConnected;
  int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
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

  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Samples& samples() const { return samples_; }

 private:
  Surface surface_;
  Samples samples_;
  TrackerOptions options_;
  std::vector<SampleClass> classes_;
  double target_energy_;
  Restoration restoration_;
};

}  // namespace dapple
