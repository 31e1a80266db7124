// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>

namespace dapple {

struct PopulationOptions {
  /// Duration in which a sample appears or vanishes.
  int fade = 12;  // expert, >= 1, frames
  /// Largest distance from a sample to its surface in a frame with other faces, unless that part of
  /// the surface moves farther as a whole; a sample without a surface vanishes.
  double reach = 1.0;           // expert, >= 0, local spacings
  TrackerOptions tracker = {};  // options
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const PopulationOptions& options);

/// What a Population needs beside the samples of its present frame to continue from there later, or
/// in another process. Faces are those of the present frame.
struct PopulationState {
  std::vector<double> fades = {};  ///< per sample: first those that stay, then those that vanish
  std::vector<std::int32_t> first_faces =
      {};  ///< per sample that stays, its place on the first frame, carried to these faces
  std::vector<Vec3> first_barycentric = {};
  std::vector<std::size_t> starts = {
      0};  ///< row starts of `neighbors`, one more than the number of samples that stay
  std::vector<std::int32_t> neighbors =
      {};                              ///< neighbors on the first frame, as indices of samples
  std::vector<double> densities = {};  ///< present target per class (one entry without classes)
  std::int64_t next_id = 0;            ///< larger than every id used so far
  bool settled = true;                 ///< see Tracker::settled()
  std::int64_t faces_digest = 0;       ///< of the present frame's faces; 0: not compared
};

/// Samples on a deforming surface at a constant number per area: where it grows samples appear, and
/// where it shrinks some vanish. They never pop: the `fade` of a sample goes from 0 to 1 or back,
/// and an id is never used again.
///
/// Vanishing samples move with the surface while the others close up; appearing samples take part
/// from the start.
class Population {
 public:
  /// The density of each class is kept by itself.
  /// \throw ArgumentError if the samples do not lie on the surface, their classes do not match, or
  /// options are out of range; Cancelled
  Population(Surface surface, Samples samples, PopulationOptions options = {},
             Context* context = nullptr);

  /// Move to the next frame of a body with the same faces.
  /// \return samples with `fade`: those that stay, in the order of their ids, then those that
  ///         vanish
  /// \throw SurfaceError, Cancelled; ArgumentError if the surface has grown so much that it would
  /// take more than kMostSamples samples or more ids than 32 bits hold; the population is then
  /// unchanged
  const Samples& advance(std::span<const Vec3> vertices, Context* context = nullptr);

  /// Move to a frame with any faces: fluids, remeshed and torn bodies. A surface with the same
  /// connectivity and density counts as the same body, deformed as above. On other faces each
  /// sample continues from the nearest point on its side of the surface (known from the faces'
  /// winding), if there is one within `reach`. Samples whose surface is gone vanish with it, and as
  /// many may be born elsewhere; beyond these, births and deaths are limited to the change in area
  /// plus 0.5 % of the samples.
  ///
  /// Meshes of one shape differ a little in area, so the number of samples may be off by 0.25 %.
  /// \return as above; the report's slides are measured from the points where samples continue
  /// \throw SurfaceError, Cancelled; ArgumentError also if there are classes
  const Samples& advance(const Surface& next, Context* context = nullptr);

  /// What resume() needs beside samples() and the present surface().
  [[nodiscard]] PopulationState state() const;

  /// Continue from a frame that was solved earlier, as if this population had solved it.
  /// \param frame the surface of that frame; if its faces are those of an earlier frame, that
  ///        surface, deformed
  /// \param samples, state of a population that began as this one did; positions on that frame,
  ///        or on the present one if it has the same faces
  /// \throw ArgumentError naming what does not match; the population is then unchanged
  void resume(const Surface& frame, const Samples& samples, const PopulationState& state);

  [[nodiscard]] const Surface& surface() const { return tracker_.surface(); }
  [[nodiscard]] const Samples& samples() const { return samples_; }

 private:
  struct Fading {
    std::int32_t id;
    std::int32_t face;
    Vec3 barycentric;
    double fade;
    std::int32_t of_class;
  };

  /// The state of one class.
  struct Kind {
    std::optional<Surface> surface;  // with its own density, if it has one
    double first_density = 0.0;      // number of samples per capacity
    double density = 0.0;            // the same, corrected for the area of meshes of one shape
  };

  struct Crossing;

  [[nodiscard]] std::size_t count_of(const Samples& samples, std::size_t kind) const;
  [[nodiscard]] Surface surface_of(const Tracker& tracker, std::size_t kind) const;
  [[nodiscard]] std::size_t wanted(const Tracker& tracker, std::size_t kind) const;
  [[nodiscard]] Samples resized(const Tracker& tracker, std::size_t kind, std::int64_t next_id,
                                Context* context) const;
  [[nodiscard]] bool rests_at(std::span<const Vec3> vertices) const;
  [[nodiscard]] Samples resized(const Tracker& tracker, Context* context) const;
  [[nodiscard]] std::vector<Fading> vanishing(const Samples& before, const Samples& after) const;
  [[nodiscard]] bool is_of_this_body(const Surface& other) const;
  [[nodiscard]] Surface with_kinds(const Surface& frame) const;
  void check_one_kind() const;
  [[nodiscard]] Crossing cross(const Surface& next, Context* context) const;
  [[nodiscard]] std::vector<std::int32_t> ids_of(std::span<const std::int32_t> origin) const;
  [[nodiscard]] std::vector<Fading> transferred(const std::vector<Fading>& fading,
                                                const Transfer& transfer,
                                                const Context* context) const;
  void take(Tracker tracker, std::vector<Fading> vanishing);
  void settle(Tracker tracker, std::vector<Fading> vanishing);
  void join();

  Tracker tracker_;
  PopulationOptions options_;
  std::vector<Kind> kinds_;    // one, if there are no classes
  std::int64_t next_id_;       // larger than every id used so far
  std::vector<double> fades_;  // of the tracker's samples
  std::vector<Fading> vanishing_;
  Samples samples_;
};

}  // namespace dapple
