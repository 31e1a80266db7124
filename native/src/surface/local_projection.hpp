// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

#include "surface/ordered_face.hpp"

namespace dapple {

/// Keeps projections from jumping to another sheet: petals, lips, fingers, the far side of a wall.
///
/// A point at distance D from the face f that it left is projected to the nearest point among those
/// connected to f within the ball of radius D around the point. Only faces with density are hit.
class LocalProjection {
 public:
  explicit LocalProjection(const Surface& surface) : surface_(&surface) {}

  /// The nearest points reached by walking from the faces `from` (caller's indices), one per point.
  [[nodiscard]] Projection walk(std::span<const Vec3> points, std::span<const std::int32_t> from,
                                const Context* context = nullptr) const;

  /// Correct the hits of `points`, which left the faces `from`, in place. Checked are hits on
  /// another component or on a face turned away, and hits that a straight walk over the faces does
  /// not reach: of two coincident sheets a point stays on its own.
  void mend(std::span<const Vec3> points, std::span<const std::int32_t> from, Projection& hits,
            const Context* context = nullptr) const;

  struct Hit;

 private:
  /// Put the point where a walk from the face `start` ends.
  void walk_to(const Vec3& point, OrderedFace start, std::size_t k, Projection& hits) const;

  /// The same if that point is as near as the present hit.
  void stay(const Vec3& point, OrderedFace start, std::size_t k, Projection& hits) const;
  void put(const Hit& hit, std::size_t k, Projection& hits) const;

  const Surface* surface_;
};

}  // namespace dapple
