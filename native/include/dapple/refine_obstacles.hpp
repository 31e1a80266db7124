// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>

namespace dapple {

/// Obstacles that samples keep away from.
struct Obstacles {
  std::span<const Vec3> points = {};
  std::span<const double> radii = {};  ///< one per point, > 0: no sample lies nearer than this
  std::span<const std::uint8_t> areas =
      {};  ///< one per face: nonzero means no sample on it; or empty
};

struct ObstacleOptions {
  double edge = 0.125;                ///< longest edge at the border of a ball, of its radius; > 0
  std::size_t max_faces = 1'000'000;  ///< 1..200000000; see refine()
};

/// Remove the density within balls and from whole faces: no sample on the returned surface lies
/// nearer to a point than its radius, in a straight line. Faces at the border of a ball are refined
/// first, because faces that reach into the ball lose their density altogether.
/// \return `resolved` is false if max_faces was reached; the distances hold all the same
/// \throw ArgumentError naming the first point that is not finite, radius that is not > 0, option
/// out of range; if the lengths differ or nothing is left; Cancelled
[[nodiscard]] Refined refine_obstacles(const Surface& surface, const Obstacles& obstacles,
                                       const ObstacleOptions& options = {},
                                       Context* context = nullptr);

}  // namespace dapple
