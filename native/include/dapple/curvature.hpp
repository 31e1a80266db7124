// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Curvedness of the surface at each vertex: sqrt((k1^2 + k2^2) / 2) of the principal curvatures
/// (Koenderink and van Doorn 1992), in 1 / unit; 1 / r on a sphere, 0 at vertices without a face
/// with area. Curvature tensors of the faces follow from the normals at their corners (Rusinkiewicz
/// 2004) and are averaged around the vertices. Neighbors of opposite orientation are oriented alike
/// first; a border takes the values next to it.
/// \param smoothing rounds of averaging normals, then tensors, over neighbors; 0..100
/// \return one value per vertex, in the caller's order
/// \throw ArgumentError for smoothing out of range; Cancelled
[[nodiscard]] std::vector<double> curvedness(const Surface& surface, int smoothing = 2,
                                             Context* context = nullptr);

struct CurvatureOptions {
  double exponent = 1.0;     ///< > 0
  double floor = 0.1;        ///< density where the surface is flat; in [0, 1]
  double percentile = 95.0;  ///< share of the area with density below 1, in percent; (0, 100]
  int smoothing = 2;         ///< see curvedness()
};

/// A density that grows with the curvature: floor + (1 - floor) min(1, curvedness /
/// clamp)^exponent, where clamp is the curvedness that the given share of the area does not exceed,
/// or its maximum if that is 0. On a flat surface the density is 1 everywhere.
/// \return one value per vertex, in the caller's order
/// \throw ArgumentError naming the option out of range; Cancelled
[[nodiscard]] std::vector<double> curvature_density(const Surface& surface,
                                                    const CurvatureOptions& options = {},
                                                    Context* context = nullptr);

}  // namespace dapple
