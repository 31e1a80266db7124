// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Whether a surface has vertices of these very bytes (in the caller's order).
[[nodiscard]] bool has_vertices(const Surface& surface, std::span<const Vec3> vertices);

/// How a body's shape changes from one frame to the next, apart from moving, scaling and mirroring
/// as a whole: those leave samples as even as they are.
struct Motion {
  std::vector<Vec3>
      target;           ///< the next frame, moved, scaled and mirrored to where the last one is
  double extent = 0.0;  ///< longest way of a vertex to its target, relative to the diagonal of a
                        ///< box of its spread
};

/// \param before, after vertices of the same body, as many
/// \param faces whose vertices move; one that belongs to none may be anywhere
/// \param measured those that tell how the body moves as a whole, so that the vertices that a file
/// repeats do not count more than others; at least one
[[nodiscard]] Motion motion_between(std::span<const Vec3> before, std::span<const Vec3> after,
                                    std::span<const Face> faces,
                                    std::span<const std::int32_t> measured);

/// The vertices after the share t in [0, 1] of the way to the target.
[[nodiscard]] std::vector<Vec3> part_way(std::span<const Vec3> before, const Motion& motion,
                                         double t);

}  // namespace dapple
