// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/line_network.hpp"

#include <algorithm>

namespace dapple {

std::vector<LineEdge> line_edges(const OrderedSurface& mesh, std::span<const LineKind> kinds) {
  std::vector<LineEdge> result;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    if (kinds[k] == LineKind::kNone || edge_of(mesh, h) != h) continue;
    const std::int32_t a = start_of(mesh, h), b = end_of(mesh, h);
    if (a == b) continue;
    result.push_back({h, a, b, (mesh.vertex(b) - mesh.vertex(a)).norm()});
  }
  return result;
}

LineNetwork::LineNetwork(std::vector<LineEdge> edges) : edges_(std::move(edges)) {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    at_.push_back({edges_[e].from, static_cast<std::int32_t>(e)});
    at_.push_back({edges_[e].to, static_cast<std::int32_t>(e)});
  }
  std::ranges::sort(at_);
}

Vec3 LineNetwork::ahead(const OrderedSurface& mesh, std::int32_t vertex, std::int32_t e,
                        double distance) const {
  const std::int32_t first = e;
  while (true) {
    const std::int32_t next = other_end(e, vertex);
    const Vec3 &from = mesh.vertex(vertex), &to = mesh.vertex(next);
    if (distance <= edge(e).length && edge(e).length > 0.0)
      return from + distance / edge(e).length * (to - from);
    distance -= edge(e).length;
    const std::int32_t following = after(e, next);
    if (following < 0 || following == first) return to;
    vertex = next;
    e = following;
  }
}

double LineNetwork::turn(const OrderedSurface& mesh, std::int32_t vertex, double scale) const {
  const auto around = at(vertex);
  const Vec3& here = mesh.vertex(vertex);
  const Vec3 before = here - ahead(mesh, vertex, around[0][1], scale);
  const Vec3 behind = ahead(mesh, vertex, around[1][1], scale) - here;
  const double lengths = before.norm() * behind.norm();
  return lengths > 0.0 ? before.dot(behind) / lengths : 1.0;
}

}  // namespace dapple
