// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "optimize/objective.hpp"

namespace dapple {

/// The target of a frame of a deforming surface, reached instead of a minimum (trust region only).
///
/// Every step toward the minimum of E_cvt lowers it permanently, and a long animation would turn
/// blue noise into hexagons, while deformation mostly disturbs the capacities. So the minimized
/// function is s E_cvt + lambda E_cap and the repulsion, where s follows how far E_cvt is above
/// that of the first frame: 0 while it is within a dead band.
struct Restoration {
  double cvt = std::numeric_limits<double>::infinity();  ///< n E_cvt / |S|_phi^2 of the first frame
  double dead_band = 7e-4;                               ///< above it, where s is 0
  double band = 1e-3;                                    ///< above that, where s rises to `share`
  double share = 0.3;            ///< the largest s, and the least delta of the trust region
  double variation = 4.5e-3;     ///< of the capacities (standard deviation / mean), even enough
  double first_variation = 0.0;  ///< of the first frame: no frame has to be more even
  double alpha = 0.63;           ///< least distance along the surface, in local spacings
  double overlap = 1e-3;         ///< of discs, of the distance that they should have

  /// s, the weight of E_cvt.
  [[nodiscard]] double cvt_weight(const Objective& objective, const Evaluation& state) const;

  /// Whether a state is even enough for a frame to end.
  [[nodiscard]] bool reached(const Objective& objective, const Evaluation& state) const;

  /// Whether a state is so even that the frame is skipped: as even as the first frame, with a
  /// margin.
  [[nodiscard]] bool unnecessary(const Objective& objective, const Evaluation& state) const;
};

}  // namespace dapple
