// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>

namespace dapple {

struct PopulationOptions {
  TrackerOptions tracker = {};
  int fade = 12;
  double reach = 1.0;
};

inline constexpr std::tuple kPopulationOptions = {
    Option{"fade",
           &PopulationOptions::fade,
           {1.0},
           "frames",
           Level::kExpert,
           "How long a sample takes to appear or to vanish."},
    Option{
        "reach",
        &PopulationOptions::reach,
        {},
        "local spacings",
        Level::kExpert,
        "How far from a sample its surface may be in a frame of other faces, unless that part of "
        "it moves farther as a whole; a sample without a surface vanishes."},
    Group{&PopulationOptions::tracker}};

constexpr const auto& options_of(const PopulationOptions&) { return kPopulationOptions; }

/// What a Population knows beside the samples of its present frame: with both it goes on from there
/// later, or elsewhere. Faces are those of the present frame.
struct PopulationState {
  std::vector<double> fades = {};  ///< per sample: those that stay, then those that vanish
  std::vector<std::int32_t> first_faces =
      {};  ///< per sample that stays, where it was on the first frame, carried to these faces
  std::vector<Vec3> first_barycentric = {};
  std::vector<std::size_t> starts = {
      0};  ///< rows of `neighbors`, one more than there are samples that stay
  std::vector<std::int32_t> neighbors = {};  ///< on the first frame, as indices of samples
  std::vector<double> densities = {};        ///< per class (one without classes): as wanted now
  std::int64_t next_id = 0;                  ///< above all that were ever used
  bool settled = true;                       ///< see Tracker::settled()
  std::int64_t faces_digest = 0;  ///< of the present frame's faces; 0: they are not compared
};

/// Samples on a deforming surface at a constant density per area: where it grows samples appear,
/// where it shrinks some vanish. They never pop: `fade` of a sample goes from 0 to 1 or back, and
/// an id is never used again.
///
/// Those that vanish ride on the surface while the others close up; those that appear take part
/// from the beginning.
class Population {
 public:
  /// \param classes as a Tracker takes them: the density of each is kept by itself
  /// \throw ArgumentError if the samples are not of the surface or the classes, for options out of
  /// range; Cancelled
  Population(Surface surface, Samples samples, PopulationOptions options = {},
             std::vector<SampleClass> classes = {}, Context* context = nullptr);

  /// Move to the next frame of a body with the same faces.
  /// \return samples with `fade`: those that stay, in the order of their ids, then those that
  ///         vanish
  /// \throw SurfaceError, Cancelled; ArgumentError if the surface has grown so much that it asks
  /// for more samples, or more ids, than there can be; the population is then unchanged
  const Samples& advance(std::span<const Vec3> vertices, Context* context = nullptr);

  /// Move to a frame of any faces: fluids, remeshed and torn bodies. A surface with the same
  /// connections and density is that of a deforming body, as above. On another one each sample goes
  /// on from the nearest place on its side of the surface (the faces' winding tells the sides), if
  /// there is one within `reach`. No more samples are born or die than the area changes by and
  /// 0.5 % of them, but for those whose surface is gone: these vanish with it, and others may be
  /// born elsewhere in exchange.
  ///
  /// Meshes of one shape differ a little in area; so their number of samples may be off by 0.25 %.
  /// \return as above; the report's slides are from the places that samples go on from
  /// \throw SurfaceError, Cancelled; ArgumentError also if there are classes
  const Samples& advance(const Surface& next, Context* context = nullptr);

  /// What resume() needs beside samples() and the present surface().
  [[nodiscard]] PopulationState state() const;

  /// Go on from a frame that was solved before, as if this population had solved it.
  /// \param frame the surface of that frame: where its faces are those of a frame before, that
  ///        one's, deformed
  /// \param samples, state of a population that began as this one did; positions on that frame,
  ///        or on the present one if it has the same faces
  /// \throw ArgumentError naming what does not fit; the population is then unchanged
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

  /// What is kept of a class.
  struct Kind {
    std::optional<Surface> surface;  // with its own density, if it has one
    double first_density = 0.0;      // samples per capacity
    double density = 0.0;            // the same, as far as meshes of one shape differ in area
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
  std::int64_t next_id_;       // above all that were ever used
  std::vector<double> fades_;  // of the tracker's samples
  std::vector<Fading> vanishing_;
  Samples samples_;
};

}  // namespace dapple
