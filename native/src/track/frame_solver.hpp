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

/// What is another than on the last frame: of other faces, nobody knows where there is room.
enum class Moved : int { kNothing, kDensity, kFaces };

/// Brings the samples of one body, frame by frame, back to the evenness of its first frame.
class FrameSolver {
 public:
  /// \throw ArgumentError for options out of range, or samples of a class that is not given;
  /// Cancelled
  FrameSolver(const Surface& surface, const Samples& samples, TrackerOptions options,
              Context* context);

  /// Moves back toward the first frame's pattern; see PatternMemory.
  /// \param before the sites on the last frame
  /// \param now those, carried to this one
  [[nodiscard]] Vectors recall(const Surface& surface, const Sites& before, const Sites& now) const;

  struct Restored {
    Samples samples;
    bool settled;  ///< the same frame again would gain nothing, see Minimum
  };
  /// Even samples on a frame.
  /// \param start, moves where the search begins: at the sites, moved
  /// \param home where max_slide and stickiness hold them; null: where the search begins
  /// \param idle whether to measure only
  /// \param moved what is another than on the last frame, beside the vertices
  [[nodiscard]] Restored restore(const Surface& surface, const Sites& start, const Vectors& moves,
                                 const Sites* home, bool idle, Context* context,
                                 Moved moved = Moved::kNothing) const;

  struct Passed {
    Sites sites;
    int evaluations;
  };
  /// Even sites part of the way to a frame, where nobody asks how even.
  [[nodiscard]] Passed pass(const Surface& surface, const Sites& start, const Vectors& moves,
                            const Sites& home, Context* context,
                            Moved moved = Moved::kNothing) const;

  /// For other samples of the same body.
  /// \param origin per sample its index so far, or -1 for one that is new
  /// \param now where they are, on the present frame
  [[nodiscard]] FrameSolver exchanged(std::span<const std::int32_t> origin,
                                      const Samples& now) const;

  /// For other samples on a surface of other faces, where the first frame's pattern is carried too.
  /// \param origin per sample its index so far, or -1 for one that is new
  /// \param before the surface so far
  [[nodiscard]] FrameSolver transplanted(std::span<const std::int32_t> origin, const Samples& now,
                                         const Surface& before, const Transfer& transfer,
                                         const Context* context) const;

  /// The same aims for samples of another solver.
  /// \param first, memory its first() and memory()
  [[nodiscard]] FrameSolver replaced(const Samples& now, Sites first, PatternMemory memory) const;

  /// The same aims for the same samples on other faces or another density of the body.
  /// \param first their places on the first frame, on these faces
  /// \throw ArgumentError if the classes are not as many as before; Cancelled
  [[nodiscard]] FrameSolver on_ground(const Surface& surface, const Samples& now, Sites first,
                                      std::vector<SampleClass> classes, Context* context) const;

  /// Whether a sample is where its class has no density.
  [[nodiscard]] bool any_stranded(const Surface& surface, const Sites& sites) const;

  /// Where the samples were on the first frame, on the present faces.
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
  KnownSides sides_;        // of the first frame, so that no frame has others; none for other faces
  std::vector<SampleClass> classes_;
  std::vector<std::int32_t> ids_, class_of_;  // per sample
  Sites first_;                               // on the first frame
  PatternMemory memory_;
  double target_energy_ = 0.0;
  Restoration restoration_;
  Report first_report_;
};

}  // namespace dapple
