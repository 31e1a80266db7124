// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>

#include "base/vectors.hpp"

namespace dapple {

/// Two sites on different bodies (see Joints::bodies) that are near each other in space, while
/// their cells do not touch: on the walls of a groove between two bodies, or above each other. The
/// cells know nothing of that, but it is seen.
struct Stranger {
  std::int32_t i, j;
  Vec3 offset;  ///< from j to i; not zero
};

/// All of them that are nearer than kStrange times the mean of their spacings, but not those that
/// look away from each other, as on the two sides of a plate.
/// \param spacings of the diagram's cells
[[nodiscard]] std::vector<Stranger> find_strangers(const Domain& domain, const Sites& sites,
                                                   const RestrictedVoronoi& diagram,
                                                   const std::vector<double>& spacings);

/// More than the radius of the repulsion, because steps bring sites nearer to each other.
inline constexpr double kStrange = 1.0;

}  // namespace dapple
