// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/sampler.hpp>
#include <dapple/samples.hpp>
#include <memory>
#include <optional>

namespace dapple {

struct TrackerOptions {
  /// Mu, the weight of the evenness of all classes together, relative to that of each class.
  double union_weight = 1.0;  // expert, >= 0
  // Within one frame no sample slides by half a spacing, which would be a jump.
  OptimizerOptions optimizer = {.max_evaluations = 6, .max_slide = 0.45};  // options
  /// How strongly samples return to the pattern of the first frame after a deformation; 0 lets it
  /// drift.
  double pattern_strength = 0.8;  // expert, 0..1
  /// Largest motion of the surface's shape in one step, not counting rigid motion, scaling and
  /// mirroring: frames with larger motion are split; 0 never splits.
  double longest_motion = 0.02;  // expert, >= 0, sizes of the surface
  /// Owner of a part of the surface: the nearest site that it is connected to along the surface, or
  /// the nearest site in space as in the paper.
  Cells cells = Cells::kConnected;  // expert
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Densities and radii of the samples' classes (counts are the samples'). None: they are of one
  /// class, whatever they say.
  std::vector<SampleClass> classes = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const TrackerOptions& options);

class FrameSolver;
enum class Moved : int;
class PatternMemory;
class Transfer;

/// Carries samples over a deforming surface: they move with the vertices by their barycentric
/// coordinates and are then optimized again, each keeping its index and id (paper, section 5.4).
///
/// Each frame is restored to the evenness of the first one, not minimized further: minimizing on
/// every frame would turn the samples into a hexagonal pattern, and samples that need not move
/// should not.
class Tracker {
 public:
  /// \throw ArgumentError if the samples do not lie on the surface or their classes do not match;
  /// see sample_classes(); Cancelled
  Tracker(Surface surface, Samples samples, TrackerOptions options = {},
          Context* context = nullptr);

  /// Move to the next frame. The tracker is unchanged if this throws. A frame with exactly the
  /// vertices of the last one costs nothing once the tracker has settled.
  /// \param vertices one per vertex of the surface, in the caller's order
  /// \throw SurfaceError, Cancelled
  const Samples& advance(std::span<const Vec3> vertices, Context* context = nullptr);

  /// Continue from a frame that was solved earlier, as if this tracker had solved it.
  /// \param samples the frame's faces and barycentric coordinates, one per sample of the tracker;
  ///                positions on that frame, the present one or the first
  /// \param settled the value of settled() then
  /// \throw SurfaceError, ArgumentError
  void resume(std::span<const Vec3> vertices, const Samples& samples, bool settled);

  /// Continue on other faces or another density of the same body, at the vertices of the last
  /// frame. Needed where the density depends on something that moves, so that the surface is cut
  /// differently in each frame.
  /// \param surface  the other faces, at any vertices
  /// \param vertices of the last frame
  /// \param samples  the present samples on these faces; ids and classes are kept
  /// \param first    their places on the first frame, on these faces
  /// \param classes  as many as before, on this surface
  /// \param anywhere whether samples may move to any free part of the surface, as after new parts
  /// have appeared; otherwise only samples that the density pushes together move
  /// \throw SurfaceError; ArgumentError if there are more or fewer samples or classes than before;
  /// Cancelled
  void resume_on(const Surface& surface, std::span<const Vec3> vertices, const Samples& samples,
                 const Samples& first, std::vector<SampleClass> classes = {}, bool anywhere = false,
                 Context* context = nullptr);

  /// Whether the last frame reached the evenness aimed at, so that the same frame again would
  /// change nothing.
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
  std::optional<Report> measured_;  // on the present frame; empty: not measured yet
  bool settled_ = true;             // the first frame is the reference of the others
  Moved moved_{};                   // since the last frame
};

}  // namespace dapple
