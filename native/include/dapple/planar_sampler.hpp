// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/classes.hpp>
#include <dapple/planar.hpp>

namespace dapple {

/// Samples of a flat domain.
struct PlanarSamples {
  std::vector<Vec2> positions;  ///< on the torus in [0, 1)^2
  std::vector<std::int32_t> classes;
  Report report;
};

/// Exactly `count` samples, evenly spaced and unpatterned, following the density (paper, Algorithm
/// 1). `options.locked` are sites of the domain, as FlatDomain::sites() makes them.
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] PlanarSamples sample_planar(const FlatDomain& domain, std::size_t count,
                                          const SampleOptions& options = {},
                                          Context* context = nullptr);

/// What one class of samples is to be.
struct PlanarClass {
  std::size_t count = 0;
  std::optional<Image> density = {};  ///< of the class; none: the domain's own
  double radius = 0.0;                ///< of its discs, as SampleClass::radius
  Sites locked = {};                  ///< as SampleOptions::locked; from FlatDomain::sites()
};

/// Several classes at once: see sample_classes(). Images are of one shape, the domain's own too
/// unless every class brings one.
/// \throw ArgumentError naming an option, radius or image out of range, or the first image of
/// another shape; Cancelled
[[nodiscard]] PlanarSamples sample_planar_classes(const FlatDomain& domain,
                                                  std::span<const PlanarClass> classes,
                                                  const ClassOptions& options = {},
                                                  Context* context = nullptr);

}  // namespace dapple
