// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/relax.hpp>
#include <dapple/samples.hpp>

#include "relax/participants.hpp"
#include "surface/ordered_face.hpp"
#include "surface/sides.hpp"

namespace dapple {

/// The samples of one class while they are relaxed.
struct RelaxedClass {
  std::int32_t name;  ///< see Samples::classes
  Surface surface;    ///< with its density and the sides of thin walls
  std::optional<std::size_t>
      count;  ///< wanted number; none: chosen to match the neighbors' capacity
  double radius = 0.0;
  std::vector<std::int32_t> rows = {};  ///< indices of the given samples; inserted ones follow
  Sites sites = {};
  std::vector<bool> locked = {}, alive = {}, free = {};
  std::vector<OrderedFace> faces = {};  ///< faces of the last region; sorted
  Report report = {};
};

/// The report: the work done, and the evenness of each class.
[[nodiscard]] Report report_of(std::span<const RelaxedClass> classes);

/// Relaxes one class after another, rare ones first: each together with classes that are as rare or
/// rarer, where something has changed and where those classes have moved.
class ClassRelaxation {
 public:
  /// \param samples, options must outlive this
  /// \param sites   the present positions of the samples
  /// \param changed the caller's faces
  ClassRelaxation(const Surface& surface, const Samples& samples, const Sites& sites,
                  std::span<const std::int32_t> changed, const RelaxOptions& options);

  /// \throw ArgumentError for a count that cannot be reached; Cancelled
  void run(Context* context);

  /// Whether there was anything to relax.
  [[nodiscard]] bool has_relaxed() const { return relaxed_; }
  [[nodiscard]] std::span<const RelaxedClass> classes() const { return classes_; }

 private:
  void add(std::int32_t name, const Surface& surface, std::optional<std::size_t> count,
           double radius);
  void deal_out(const Samples& samples, const Sites& sites);
  [[nodiscard]] std::vector<OrderedFace> faces_to_relax(const RelaxedClass& one) const;
  [[nodiscard]] Participants participants_of(std::span<const std::size_t> group) const;
  void begin(RelaxedClass& one, std::size_t count, Context* context) const;
  void relax(std::size_t c, Context* context);
  void relax_together(std::span<const std::size_t> group, Context* context);
  void store(std::span<const std::size_t> group, std::span<const FreeClass> free_classes,
             const Minimum& found);
  void note_moves(const RelaxedClass& one, const Sites& before);

  const RelaxOptions& options_;
  std::vector<std::int32_t> changed_;          // the caller's, and where classes have moved
  std::shared_ptr<const SidedSurface> sides_;  // of walls; null where there are none
  std::vector<RelaxedClass> classes_;
  std::vector<bool> done_;
  bool relaxed_ = false;
};

}  // namespace dapple
