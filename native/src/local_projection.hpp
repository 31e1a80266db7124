// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

namespace dapple {

/// Keeps projections from hopping to another sheet: petals, lips, fingers, the far side of a wall.
///
/// A point that left face f at distance D is projected to the nearest point among those that are
/// connected to f within the ball of radius D around the point: walking along the surface one would
/// meet no better one first. Only hits on another component or on a face turned away are looked at,
/// and only faces with density are hit.
class LocalProjection {
 public:
  explicit LocalProjection(const Surface& surface) : surface_(&surface) {}

  /// Mend the hits of `points`, which left the faces `from` (caller's indices), in place.
  void mend(std::span<const Vec3> points, std::span<const std::int32_t> from,
            Projection& hits) const;

 private:
  const Surface* surface_;
};

}  // namespace dapple
