// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/analysis.hpp>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Measures of evenness of a set of samples.
struct Quality {
  std::size_t count = 0;
  double spacing = 0.0;  ///< hexagonal packing distance, in the surface's units
  Evenness evenness;
  double bond_order = 0.0;  ///< psi6, see bond_order(); without cells at borders
  double energy = 0.0;      ///< normalized, see Energy::normalized
  /// Share of the capacity variation caused by integer counts per component, which no optimization
  /// can lower; 0 on one component.
  double whole_count_variation = 0.0;
};

/// How samples were computed and how even they are, all together and class by class.
struct Report : Quality {
  std::vector<Quality> classes;  ///< empty if there is only one class
  /// The pair of discs that overlaps most: 1 - distance / sum of the radii (0 if none does), and
  /// its indices.
  double worst_overlap = 0.0;
  std::array<std::int32_t, 2> overlapping = {-1, -1};
  int evaluations = 0;
  int parts =
      1;  ///< tracker: number of parts that the frame was split into, because the surface moves far
  int iterations = 0;
  bool converged = true;
  double seconds = 0.0;  ///< wall time
  Profile profile;       ///< by stage; sums to `seconds`
  std::vector<double>
      energies;  ///< the objective, normalized, at the start and after each iteration
  double slide_mean =
      0.0;  ///< tracker, resample: distance from the carried or earlier position, in spacings
  double slide_median = 0.0;
  double slide_max = 0.0;
  std::size_t births = 0;  ///< population: number of samples that start to appear in this frame
  std::size_t deaths = 0;  ///< population: number of samples that start to vanish in this frame
};

/// Samples on a surface. Index and id identify a sample; trackers keep both.
struct Samples {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;        ///< unit shading normals
  std::vector<std::int32_t> faces;  ///< the caller's indices
  std::vector<Vec3> barycentric;    ///< >= 0, sum 1
  std::vector<std::int32_t> ids;
  std::vector<std::int32_t> classes;
  std::vector<double> fade = {};  ///< 0..1, how far each has appeared; empty if all are fully there
  Report report = {};

  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// Samples from stored faces and barycentric coordinates. Empty ids stand for 0, 1, 2, ...; empty
/// classes for 0.
/// \throw ArgumentError naming the first face out of range, barycentric coordinate that is not
/// finite or below 0, or row that does not sum to 1 within 1e-4 (rows stored in single precision
/// are accepted and normalized)
[[nodiscard]] Samples bind_samples(const Surface& surface, std::span<const std::int32_t> faces,
                                   std::span<const Vec3> barycentric,
                                   std::span<const std::int32_t> ids = {},
                                   std::span<const std::int32_t> classes = {});

/// Measure any samples at the cost of one evaluation: count, spacing, evenness, bond order and
/// energy. Other members of the report keep their defaults.
/// \param surface the surface that they lie on
/// \throw SurfaceError if vertices are so far apart that the energy is not finite; Cancelled
[[nodiscard]] Report analyze(const Surface& surface, const Samples& samples,
                             double capacity_weight = 30.0, Cells cells = Cells::kConnected,
                             Context* context = nullptr);

}  // namespace dapple
