// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <compare>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <vector>

#include "surface/ordered_face.hpp"

namespace dapple {

/// A point where an edge passes through a face.
struct Crossing {
  std::int32_t edge = 0;  ///< see edge_of()
  OrderedFace face{};     ///< the face that it passes through
  double share = 0.0;     ///< how far along the edge, from its lower welded vertex; 0..1
  Vec3 position = Vec3::Zero();

  [[nodiscard]] std::strong_ordering operator<=>(const Crossing& other) const {
    if (edge != other.edge) return edge <=> other.edge;
    return face <=> other.face;
  }
  [[nodiscard]] bool operator==(const Crossing& other) const {
    return edge == other.edge && face == other.face;
  }
};

/// A segment in a face, along which another face passes through it.
struct CrossingLine {
  OrderedFace face{};
  std::array<std::int32_t, 2> ends{};  ///< indices of crossings
};

/// All places where faces pass through each other.
struct Crossings {
  std::vector<Crossing> points;     ///< sorted by edge, then by face
  std::vector<CrossingLine> lines;  ///< sorted by face
};

/// Whether two faces, given by their welded corners, have a vertex in common.
[[nodiscard]] bool share_vertex(const Face& a, const Face& b);

/// Find where faces without a common vertex pass through each other. Predicates are exact, so faces
/// on either side of an edge agree on what passes through it; faces that lie on each other do not
/// cross.
/// \throw Cancelled
[[nodiscard]] Crossings find_crossings(const Surface& surface, Context* context = nullptr);

}  // namespace dapple
