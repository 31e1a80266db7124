// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/planar.hpp>
#include <dapple/sampler.hpp>

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
[[nodiscard]] PlanarSamples sample(const FlatDomain& domain, std::size_t count,
                                   const SampleOptions& options = {}, Context* context = nullptr);

/// Samples of several classes at once, as on a surface. All images must have one shape, including
/// the domain's own unless every class has one.
/// \throw ArgumentError naming an option, radius or image out of range, or the first image of
/// another shape; Cancelled
[[nodiscard]] PlanarSamples sample_classes(const FlatDomain& domain,
                                           std::span<const SampleClass> classes,
                                           const ClassOptions& options = {},
                                           Context* context = nullptr);

}  // namespace dapple
