// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/sets.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

/// Why an edge is part of a line.
enum class LineKind : std::uint8_t {
  kNone,
  kBorder,  ///< it has one face
  kSeam,    ///< three or more faces meet, or two of opposite orientation
  kMarked,  ///< the caller has marked it
  kCrease,  ///< its faces differ by more than the feature angle
};

/// Which edges count as lines.
struct LineRules {
  double feature_angle = 30.0;  ///< degrees; 180: no edge is a crease
  double corner_angle = 45.0;   ///< degrees by which a line turns at a corner
  /// Distance over which turns are measured. Lines of creases that are shorter in total are left
  /// out, and so are shorter ends of them.
  double scale = 0.0;
  std::span<const std::array<std::int32_t, 2>> marked = {};  ///< by the caller's vertices
  bool borders = true;                                       ///< and edges that are not manifold
};

[[nodiscard]] inline std::int32_t start_of(const OrderedSurface& mesh, std::int32_t h) {
  return mesh.welded_corners(face_of(h))[static_cast<std::size_t>(h % 3)];
}

[[nodiscard]] inline std::int32_t end_of(const OrderedSurface& mesh, std::int32_t h) {
  return mesh.welded_corners(face_of(h))[static_cast<std::size_t>((h + 1) % 3)];
}

[[nodiscard]] inline int faces_around(const OrderedSurface& mesh, std::int32_t h) {
  int count = 1;
  for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) ++count;
  return count;
}

/// The only other half-edge of an edge with two faces; -1 where there is none, or several.
[[nodiscard]] inline std::int32_t twin_of(const OrderedSurface& mesh, std::int32_t h) {
  const std::int32_t g = mesh.next_around(h);
  return g != h && mesh.next_around(g) == h ? g : -1;
}

/// The corners of faces, half-edges as well, in fans: those around a vertex that are connected over
/// edges.
[[nodiscard]] inline Sets fans_of(const OrderedSurface& mesh) {
  const auto halves = static_cast<std::int32_t>(3 * mesh.face_count());
  const auto end = [](std::int32_t half) { return half - half % 3 + (half + 1) % 3; };
  Sets fans(static_cast<std::size_t>(halves));
  for (std::int32_t h = 0; h < halves; ++h)
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) {
      const bool opposite = start_of(mesh, h) != start_of(mesh, g);
      fans.join(h, opposite ? end(g) : g);
      fans.join(end(h), opposite ? g : end(g));
    }
  return fans;
}

/// Visit each half-edge of an edge.
template <typename Visit>
void for_each_half_edge(const OrderedSurface& mesh, std::int32_t h, const Visit& visit) {
  std::int32_t g = h;
  do {
    visit(g);
    g = mesh.next_around(g);
  } while (g != h);
}

}  // namespace dapple
