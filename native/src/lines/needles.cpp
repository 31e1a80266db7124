// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/needles.hpp"

#include <algorithm>

#include "lines/line_edges.hpp"

namespace dapple {
namespace {

constexpr double kNeedle = 0.02;  // of its longest edge, and of the scale: the height of a needle
constexpr int kMostNeedles = 8;   // side by side

/// Whether a face is so narrow that its normal means nothing, and which is its longest edge.
bool is_needle(const OrderedSurface& mesh, OrderedFace face, double scale, std::int32_t& longest) {
  double most = 0.0;
  for (std::int32_t c = 0; c < 3; ++c) {
    const std::int32_t h = half_edge(face, c);
    const double length = (mesh.vertex(end_of(mesh, h)) - mesh.vertex(start_of(mesh, h))).norm();
    if (length > most) longest = h;
    most = std::max(most, length);
  }
  const double height = most > 0.0 ? 2.0 * mesh.geometry(face).moments.area / most : 0.0;
  return height <= kNeedle * std::min(most, scale);
}

}  // namespace

std::int32_t beside_needles(const OrderedSurface& mesh, std::int32_t h, double scale) {
  for (int steps = 0; steps < kMostNeedles; ++steps) {
    std::int32_t longest = h;
    if (!is_needle(mesh, face_of(h), scale, longest)) return h;
    if (longest != h) return -1;
    std::int32_t next = -1;
    double most = -1.0;
    for (std::int32_t c = 0; c < 3; ++c) {
      const std::int32_t other = half_edge(face_of(h), c);
      const double length =
          (mesh.vertex(end_of(mesh, other)) - mesh.vertex(start_of(mesh, other))).norm();
      if (other == h || length <= most) continue;
      most = length;
      next = twin_of(mesh, other);
    }
    if (next < 0) return -1;
    h = next;
    std::int32_t beyond = h;
    if (is_needle(mesh, face_of(h), scale, beyond) && beyond != h) return -1;
  }
  return -1;
}

}  // namespace dapple
