// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/domain.hpp>
#include <dapple/sampler.hpp>
#include <dapple/samples.hpp>
#include <dapple/tracker.hpp>

#include "optimize/restoration.hpp"
#include "track/pattern_memory.hpp"
#include "track/transfer.hpp"

namespace dapple {

[[nodiscard]] Sites sites_of(const Samples& samples);

/// The sites at the same places of their faces, on another frame of the surface.
[[nodiscard]] Sites carried(const Surface& surface, Sites sites);

/// What differs from the last frame. On other faces it is unknown where there is room.
enum class Moved : int { kNothing, kDensity, kFaces };

/// Restores the samples of a body, frame by frame, to the evenness of the first frame.
class FrameSolver {
 public:
  /// \throw ArgumentError for options out of range, or samples of a class that is not given;
  /// Cancelled
  FrameSolver(const Surface& surface, const Samples& samples, TrackerOptions options,
              Context* context);

  /// Moves back toward the first frame's pattern; see PatternMemory.
  /// \param before the sites on the last frame
  /// \param now the same sites, carried to this frame
  [[nodiscard]] Vectors recall(const Surface& surface, const Sites& before, const Sites& now) const;

  struct Restored {
    Samples samples;
    bool settled;  ///< the same frame again would gain nothing, see Minimum
  };
  /// Optimize the samples of a frame.
  /// \param start, moves the initial positions: these sites, moved by `moves`
  /// \param home the places that max_slide and stickiness refer to; null: the initial positions
  /// \param idle whether to measure only
  /// \param moved what differs from the last frame, apart from the vertices
  [[nodiscard]] Restored restore(const Surface& surface, const Sites& start, const Vectors& moves,
                                 const Sites* home, bool idle, Context* context,
                                 Moved moved = Moved::kNothing) const;

  struct Passed {
    Sites sites;
    int evaluations;
  };
  /// Optimize the sites at an intermediate position between two frames, without a report.
  [[nodiscard]] Passed pass(const Surface& surface, const Sites& start, const Vectors& moves,
                            const Sites& home, Context* context,
                            Moved moved = Moved::kNothing) const;

  /// The solver for other samples of the same body.
  /// \param origin per sample its previous index, or -1 if it is new
  /// \param now their places on the present frame
  [[nodiscard]] FrameSolver exchanged(std::span<const std::int32_t> origin,
                                      const Samples& now) const;

  /// The solver for other samples on a surface of other faces, with the first frame's pattern
  /// carried along.
  /// \param origin per sample its previous index, or -1 if it is new
  /// \param before the surface so far
  [[nodiscard]] FrameSolver transplanted(std::span<const std::int32_t> origin, const Samples& now,
                                         const Surface& before, const Transfer& transfer,
                                         const Context* context) const;

  /// The same targets for samples of another solver.
  /// \param first, memory its first() and memory()
  [[nodiscard]] FrameSolver replaced(const Samples& now, Sites first, PatternMemory memory) const;

  /// The same targets for the same samples on other faces or another density of the body.
  /// \param first their places on the first frame, on these faces
  /// \throw ArgumentError if the classes are not as many as before; Cancelled
  [[nodiscard]] FrameSolver on_ground(const Surface& surface, const Samples& now, Sites first,
                                      std::vector<SampleClass> classes, Context* context) const;

  /// Whether a sample lies where its class has no density.
  [[nodiscard]] bool any_stranded(const Surface& surface, const Sites& sites) const;

  /// The places of the samples on the first frame, on the present faces.
  [[nodiscard]] const Sites& first() const { return first_; }
  [[nodiscard]] const PatternMemory& memory() const { return memory_; }
  [[nodiscard]] const TrackerOptions& options() const { return options_; }
  /// Of the first frame, as it was given.
  [[nodiscard]] const Report& first_report() const { return first_report_; }

 private:
  [[nodiscard]] OptimizerOptions aims() const;
  [[nodiscard]] Restoration restoration(Moved moved, const Domain& all, const Sites& sites) const;
  [[nodiscard]] FrameSolver with(const Samples& now) const;

  TrackerOptions options_;  // without classes
  KnownSides sides_;        // of the first frame, kept for all frames; none on other faces
  std::vector<SampleClass> classes_;
  std::vector<std::int32_t> ids_, class_of_;  // per sample
  Sites first_;                               // on the first frame
  PatternMemory memory_;
  double target_energy_ = 0.0;
  Restoration restoration_;
  Report first_report_;
};

}  // namespace dapple
