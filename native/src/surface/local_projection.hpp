// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

#include "surface/ordered_face.hpp"

namespace dapple {

/// Keeps projections from hopping to another sheet: petals, lips, fingers, the far side of a wall.
///
/// A point that left face f at distance D is projected to the nearest point among those that are
/// connected to f within the ball of radius D around the point: walking along the surface one would
/// meet no better one first. Only faces with density are hit.
class LocalProjection {
 public:
  explicit LocalProjection(const Surface& surface) : surface_(&surface) {}

  /// The nearest points met by walking from the faces `from` (caller's indices), one per point.
  [[nodiscard]] Projection walk(std::span<const Vec3> points, std::span<const std::int32_t> from,
                                const Context* context = nullptr) const;

  /// Mend the hits of `points`, which left the faces `from`, in place. Only hits on another
  /// component or on a face turned away are looked at, and those to which going straight over the
  /// faces does not lead: of two sheets at one place a point stays on its own.
  void mend(std::span<const Vec3> points, std::span<const std::int32_t> from, Projection& hits,
            const Context* context = nullptr) const;

  struct Hit;

 private:
  /// Put the point where a walk from the face `start` ends.
  void walk_to(const Vec3& point, OrderedFace start, std::size_t k, Projection& hits) const;

  /// The same if that is as near as the hit that is there.
  void stay(const Vec3& point, OrderedFace start, std::size_t k, Projection& hits) const;
  void put(const Hit& hit, std::size_t k, Projection& hits) const;

  const Surface* surface_;
};

}  // namespace dapple
