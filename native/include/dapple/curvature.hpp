// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// How strongly the surface bends at each vertex: sqrt((k1^2 + k2^2) / 2) of the principal
/// curvatures (Koenderink and van Doorn 1992), in 1 / unit; 1 / r on a sphere, 0 where no face with
/// area is. Curvature tensors of the faces follow from the normals at their corners (Rusinkiewicz
/// 2004) and are averaged around the vertices. Neighbors that are turned against each other are
/// turned the same way first; a border takes over what lies next to it.
/// \param smoothing rounds of averaging normals, then tensors, over neighbors; 0..100
/// \return one value per vertex, in the caller's order
/// \throw ArgumentError for smoothing out of range; Cancelled
[[nodiscard]] std::vector<double> curvedness(const Surface& surface, int smoothing = 2,
                                             Context* context = nullptr);

struct CurvatureOptions {
  double exponent = 1.0;  ///< > 0
  double floor = 0.1;     ///< density where the surface is flat; in [0, 1]
  double percentile =
      95.0;           ///< of the area, that reaches up to the curvature of density 1; (0, 100]
  int smoothing = 2;  ///< see curvedness()
};

/// A density that grows with the curvature:
/// floor + (1 - floor) min(1, curvedness / clamp)^exponent, where clamp is the curvedness that the
/// given share of the area does not exceed; its maximum where that is 0. It is 1 everywhere on a
/// surface that is flat.
/// \return one value per vertex, in the caller's order
/// \throw ArgumentError naming the option out of range; Cancelled
[[nodiscard]] std::vector<double> curvature_density(const Surface& surface,
                                                    const CurvatureOptions& options = {},
                                                    Context* context = nullptr);

}  // namespace dapple
