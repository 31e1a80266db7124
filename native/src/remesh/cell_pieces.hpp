// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <span>
#include <vector>

#include "lines/feature_lines.hpp"

namespace dapple {

/// The pieces of all cells with their edges in a row, turned so that neighboring faces agree.
class CellPieces {
 public:
  /// What an edge lies on, if it is no bisector.
  static constexpr std::int32_t kOnEdge = -1;

  CellPieces(const Surface& surface, const FeatureLines& lines,
             std::span<const CellPolygon> polygons, std::size_t sites);

  [[nodiscard]] std::size_t edge_count() const { return from_.size(); }
  [[nodiscard]] std::int32_t piece_of(std::int32_t edge) const { return pieces_[as_index(edge)]; }
  [[nodiscard]] std::int32_t first_edge(std::int32_t piece) const {
    return firsts_[as_index(piece)];
  }
  [[nodiscard]] std::int32_t site_of(std::int32_t piece) const { return sites_[as_index(piece)]; }
  /// The caller's face of a piece.
  [[nodiscard]] std::int32_t face_of_piece(std::int32_t piece) const {
    return faces_[as_index(piece)];
  }
  [[nodiscard]] std::int32_t next(std::int32_t edge) const {
    const std::int32_t piece = piece_of(edge);
    return edge + 1 == first_edge(piece + 1) ? first_edge(piece) : edge + 1;
  }
  [[nodiscard]] const Vec3& from(std::int32_t edge) const { return from_[as_index(edge)]; }
  [[nodiscard]] const Vec3& to(std::int32_t edge) const { return from(next(edge)); }
  [[nodiscard]] double length(std::int32_t edge) const { return (to(edge) - from(edge)).norm(); }
  /// The site beyond the bisector; kOnEdge for an edge of the mesh.
  [[nodiscard]] std::int32_t rival(std::int32_t edge) const { return rivals_[as_index(edge)]; }
  /// The ordered half-edge that it lies on; -1 on a bisector.
  [[nodiscard]] std::int32_t half_edge(std::int32_t edge) const {
    return half_edges_[as_index(edge)];
  }
  /// The pieces of a site.
  [[nodiscard]] std::int32_t first_piece(std::size_t site) const { return rows_[site]; }
  /// The pieces on an ordered face, by site.
  [[nodiscard]] std::span<const std::int32_t> on_face(OrderedFace face) const {
    const std::size_t first = face_rows_[as_index(face)];
    return std::span(by_face_).subspan(first, face_rows_[as_index(face) + 1] - first);
  }

 private:
  void place(const Surface& surface, const FeatureLines& lines, const CellPolygon& polygon,
             std::size_t piece);
  void index_faces(const Surface& surface);

  std::vector<Vec3> from_;
  std::vector<std::int32_t> rivals_, half_edges_, pieces_;  // per edge
  std::vector<std::int32_t> firsts_, sites_, faces_;        // per piece; one more of the first
  std::vector<std::int32_t> rows_;                          // per site, one more
  std::vector<std::size_t> face_rows_;                      // per ordered face, one more
  std::vector<std::int32_t> by_face_;
};

}  // namespace dapple
