// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Where points have no neighbors: for each point the mean of the unit vectors that lead away from
/// its neighbors, with the weights (1 - distance / reach)^2. Its reach is three times the distance
/// to the nearest other point; neighbors are those of the 24 nearest that are within it. Weights
/// count as at least 1 in all, so that one neighbor counts less than many. Among even points the
/// mean is short, at a straight border about 0.5 long, and never longer than 1.
///
/// \return 0 for a point that lies on another one, or has no other
/// \throw ArgumentError naming the first point that is not finite
[[nodiscard]] std::vector<Vec3> away_from_neighbors(std::span<const Vec3> points);

}  // namespace dapple
