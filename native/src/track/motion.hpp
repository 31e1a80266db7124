// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <span>
#include <vector>

namespace dapple {

/// The change of a body's shape from one frame to the next, apart from moving, scaling and
/// mirroring as a whole, which do not affect evenness.
struct Motion {
  std::vector<Vec3> target;  ///< the next frame, moved, scaled and mirrored onto the last one
  double extent = 0.0;  ///< longest distance of a vertex from its target, relative to the diagonal
                        ///< of a box of its spread
};

/// \param before, after vertices of the same body, as many
/// \param faces whose vertices count; a vertex without a face is ignored
/// \param measured the vertices from which the motion as a whole is estimated, without repeated
/// ones, so that all count alike; at least one
[[nodiscard]] Motion motion_between(std::span<const Vec3> before, std::span<const Vec3> after,
                                    std::span<const Face> faces,
                                    std::span<const std::int32_t> measured);

/// The vertices after the share t in [0, 1] of the way to the target.
[[nodiscard]] std::vector<Vec3> part_way(std::span<const Vec3> before, const Motion& motion,
                                         double t);

}  // namespace dapple
