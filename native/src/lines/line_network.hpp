// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lines/line_edges.hpp"

namespace dapple {

/// An edge of a line, between welded vertices.
struct LineEdge {
  std::int32_t half_edge, from, to;
  double length;
};

[[nodiscard]] std::vector<LineEdge> line_edges(const OrderedSurface& mesh,
                                               std::span<const LineKind> kinds);

/// The lines' edges at each vertex.
class LineNetwork {
 public:
  explicit LineNetwork(std::vector<LineEdge> edges);

  [[nodiscard]] const std::vector<LineEdge>& edges() const { return edges_; }
  [[nodiscard]] const LineEdge& edge(std::int32_t e) const { return edges_[as_index(e)]; }

  using Entry = std::array<std::int32_t, 2>;  // vertex, edge
  [[nodiscard]] std::span<const Entry> at(std::int32_t vertex) const {
    const auto first = std::ranges::lower_bound(at_, Entry{vertex, -1});
    const auto last = std::ranges::lower_bound(at_, Entry{vertex + 1, -1});
    return {first, last};
  }
  [[nodiscard]] std::vector<std::int32_t> vertices() const {
    std::vector<std::int32_t> result;
    for (const Entry& entry : at_)
      if (result.empty() || result.back() != entry[0]) result.push_back(entry[0]);
    return result;
  }
  [[nodiscard]] std::int32_t other_end(std::int32_t e, std::int32_t vertex) const {
    return edge(e).from == vertex ? edge(e).to : edge(e).from;
  }
  /// The edge after `e` at a vertex of two edges; -1 elsewhere.
  [[nodiscard]] std::int32_t after(std::int32_t e, std::int32_t vertex) const {
    const auto around = at(vertex);
    if (around.size() != 2) return -1;
    return around[0][1] == e ? around[1][1] : around[0][1];
  }

  /// The place on the line at a distance from a vertex, in the direction of an edge.
  [[nodiscard]] Vec3 ahead(const OrderedSurface& mesh, std::int32_t vertex, std::int32_t e,
                           double distance) const;

  /// Cosine of the turn of the line at a vertex of two edges.
  [[nodiscard]] double turn(const OrderedSurface& mesh, std::int32_t vertex, double scale) const;

 private:
  std::vector<LineEdge> edges_;
  std::vector<Entry> at_;
};

}  // namespace dapple
