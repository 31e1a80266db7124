// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/class_options.hpp>
#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <dapple/tracker_options.hpp>
#include <memory>
#include <optional>

namespace dapple {

class FrameSolver;
enum class Moved : int;
class PatternMemory;
class Transfer;

/// Carries samples over a deforming surface: they ride the moved vertices by their barycentric
/// coordinates and are then re-optimized, each keeping its index and id (paper, section 5.4).
///
/// A frame is restored to the evenness of the first one, not minimized on: minimizing on every
/// frame would turn the samples into a hexagonal pattern, and samples that need not move should
/// not.
class Tracker {
 public:
  /// \param classes densities and radii of the samples' classes (counts are the samples'); empty:
  ///                 one class, whatever the samples say
  /// \throw ArgumentError if the samples are not of the surface or the classes; see
  /// sample_classes(); Cancelled
  Tracker(Surface surface, Samples samples, TrackerOptions options = {},
          std::vector<SampleClass> classes = {}, Context* context = nullptr);

  /// Move to the next frame. The tracker is unchanged if this throws. A frame with the very
  /// vertices of the last one costs nothing, once nothing is left to be caught up.
  /// \param vertices as many as the surface has, in the caller's order
  /// \throw SurfaceError, Cancelled
  const Samples& advance(std::span<const Vec3> vertices, Context* context = nullptr);

  /// Go on from a frame that was solved before, as if this tracker had solved it.
  /// \param samples the frame's faces and barycentric coordinates, as many as the tracker has;
  ///                positions on that frame, the present one or the first
  /// \param settled what settled() said then
  /// \throw SurfaceError, ArgumentError
  void resume(std::span<const Vec3> vertices, const Samples& samples, bool settled);

  /// Go on on other faces or another density of the same body, which has not moved since the last
  /// frame: where what the density depends on moves, a surface is cut along it anew.
  /// \param surface  the other faces, wherever the body is
  /// \param vertices of the last frame
  /// \param samples  where the present samples are on these faces; ids and classes stay
  /// \param first    where they were on the first frame, on these faces
  /// \param classes  as many as before, on this surface
  /// \param anywhere whether samples may go to wherever there is room, as on a surface that has got
  /// other parts; else only those that the density pushes together
  /// \throw SurfaceError; ArgumentError if there are more or fewer samples or classes than before;
  /// Cancelled
  void resume_on(const Surface& surface, std::span<const Vec3> vertices, const Samples& samples,
                 const Samples& first, std::vector<SampleClass> classes = {}, bool anywhere = false,
                 Context* context = nullptr);

  /// Whether nothing was left to be caught up when the last frame was done.
  [[nodiscard]] bool settled() const { return settled_; }
  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Samples& samples() const { return samples_; }

 private:
  friend class Population;
  void exchange(const Samples& samples);
  void cross(const Surface& next, const Transfer& transfer, std::span<const std::int32_t> origin,
             const Samples& now, Context* context);
  void replace(const Surface& frame, Samples samples, Sites first, PatternMemory memory,
               bool settled);
  [[nodiscard]] bool rests_at(std::span<const Vec3> vertices) const;

  Surface first_surface_;
  Surface surface_;
  Samples samples_;
  std::shared_ptr<const FrameSolver> solver_;
  std::optional<Report> measured_;  // on the present frame; empty: nobody has asked how even it is
  bool settled_ = true;             // the first frame is what the others are held against
  Moved moved_{};                   // since the last frame; nothing
};

}  // namespace dapple
