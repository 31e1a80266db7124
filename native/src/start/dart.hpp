// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>

#include "surface/ordered_face.hpp"

namespace dapple {

/// A point thrown at a surface.
struct Dart {
  Vec3 position;
  Vec3 barycentric;
  Vec3 normal;
  OrderedFace face;
  std::int32_t component;
  double density;  ///< there
};

/// Whether two darts are on the same side of a wall.
template <typename A, typename B>
[[nodiscard]] bool on_one_side(const A& a, const B& b) {
  return a.normal.dot(b.normal) > -0.5;
}

/// Whether straight distance stands for distance along the surface: not between components, nor
/// between the two sides of a wall.
template <typename A, typename B>
[[nodiscard]] bool see_each_other(const A& a, const B& b) {
  return a.component == b.component && on_one_side(a, b);
}

/// The dart at a site of the surface.
[[nodiscard]] Dart dart_at(const Surface& surface, OrderedFace face, const Vec3& weights);

}  // namespace dapple
