// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/analysis.hpp>
#include <dapple/profile.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// How even a set of samples is.
struct Quality {
  std::size_t count = 0;
  double spacing = 0.0;  ///< hexagonal packing distance, in the surface's units
  Evenness evenness;
  double bond_order = 0.0;  ///< psi6, see bond_order(); cells at borders are left out
  double energy = 0.0;      ///< normalized, see Energy::normalized
  /// What of the capacity variation comes of each component having a whole number of samples: no
  /// optimization can lower it. 0 on one component.
  double whole_count_variation = 0.0;
};

/// What was done to get the samples, and how good they are: all together, and each class.
struct Report : Quality {
  std::vector<Quality> classes;  ///< empty if there is one class only
  /// Of discs: 1 - distance / sum of the radii of the pair that overlaps most, 0 if
  /// none does, and the indices of the pair.
  double worst_overlap = 0.0;
  std::array<std::int32_t, 2> overlapping = {-1, -1};
  int evaluations = 0;
  int parts = 1;  ///< tracker: that the frame was split into, because the surface moves far
  int iterations = 0;
  bool converged = true;
  double seconds = 0.0;  ///< wall time
  Profile profile;       ///< what it went to; sums to `seconds`
  std::vector<double>
      energies;  ///< what was minimized, normalized, at the start and after each iteration
  double slide_mean = 0.0;  ///< tracker, resample: distance from where they were, in spacings
  double slide_median = 0.0;
  double slide_max = 0.0;
  std::size_t births = 0;  ///< population: samples that appear from this frame on
  std::size_t deaths = 0;  ///< population: those that vanish from this frame on
};

/// Samples on a surface. Index k is a sample's identity together with ids[k]; trackers keep both.
struct Samples {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;        ///< unit, as the surface is shaded there
  std::vector<std::int32_t> faces;  ///< the caller's indices
  std::vector<Vec3> barycentric;    ///< >= 0, sum 1
  std::vector<std::int32_t> ids;
  std::vector<std::int32_t> classes;
  std::vector<double> fade = {};  ///< 0..1, how far each has appeared; empty: all are there
  Report report = {};

  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// Samples from stored bindings. Empty ids count up from 0, empty classes are 0.
/// \throw ArgumentError naming the first face out of range, barycentric coordinate that is not
/// finite or below 0, row that does not sum to 1 (within 1e-4: they may have been stored in single
/// precision; they are normalized)
[[nodiscard]] Samples bind_samples(const Surface& surface, std::span<const std::int32_t> faces,
                                   std::span<const Vec3> barycentric,
                                   std::span<const std::int32_t> ids = {},
                                   std::span<const std::int32_t> classes = {});

/// Measure samples, wherever they come from, at the price of one evaluation: count, spacing,
/// evenness, bond order and energy; what tells of the making stays at its default.
/// \param surface the surface they lie on
/// \throw SurfaceError if vertices are so far apart that the energy is not finite; Cancelled
[[nodiscard]] Report analyze(const Surface& surface, const Samples& samples,
                             double capacity_weight = 30.0, Cells cells = Cells::kConnected,
                             Context* context = nullptr);

}  // namespace dapple
