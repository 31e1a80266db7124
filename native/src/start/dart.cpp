// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/dart.hpp"

#include "surface/ordered_surface.hpp"

namespace dapple {

Dart dart_at(const Surface& surface, OrderedFace face, const Vec3& weights) {
  const OrderedSurface& ordered = surface.ordered();
  return {ordered.point(face, weights),  weights,
          ordered.geometry(face).normal, face,
          ordered.component(face),       weights.dot(ordered.densities(face))};
}

}  // namespace dapple
