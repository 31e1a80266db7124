// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// The edges of a surface's faces, numbered within chunks of consecutive faces, so that what is
/// computed for the edges of a chunk stays in the cache. An edge between two chunks belongs to
/// both. Depends on the connectivity alone.
class FaceEdges {
 public:
  static constexpr std::size_t kFaces = 1024;     // per chunk
  static constexpr std::size_t kVertices = 1024;  // per chunk of vertices

  explicit FaceEdges(const OrderedSurface& mesh);

  /// The two vertices of an edge, the lower one first.
  using Ends = std::array<std::int32_t, 2>;

  /// The edges of a face by their numbers in its chunk; edge k runs from corner k to corner k + 1.
  struct OfFace {
    std::array<std::uint16_t, 3> edges;
    std::uint16_t upward;  ///< bit k: edge k runs from its lower vertex
  };

  [[nodiscard]] std::size_t chunks() const { return first_.size() - 1; }
  [[nodiscard]] std::span<const Ends> edges(std::size_t chunk) const {
    return std::span(ends_).subspan(first_[chunk], first_[chunk + 1] - first_[chunk]);
  }
  /// The number of edges in the chunks before one, or in all of them.
  [[nodiscard]] std::size_t first_edge(std::size_t chunk) const { return first_[chunk]; }
  [[nodiscard]] const OfFace& of(OrderedFace face) const { return faces_[as_index(face)]; }

  /// The corners of the faces. Vertices are those of the surface, and behind them copies of those
  /// that several components share, so that each belongs to one.
  [[nodiscard]] std::span<const Face> corners() const { return corners_; }
  [[nodiscard]] std::size_t vertex_count() const { return face_at_.size(); }
  /// The surface's vertices that the copies are at.
  [[nodiscard]] std::span<const std::int32_t> copied() const { return copied_; }

  /// A face of a vertex; -1 if it has none.
  [[nodiscard]] std::int32_t face_at(std::int32_t vertex) const {
    return face_at_[as_index(vertex)];
  }
  /// A vertex beside this one that comes before it in its chunk of vertices; if there is none, the
  /// one before it, or the vertex itself where the chunk begins.
  [[nodiscard]] std::int32_t before(std::int32_t vertex) const { return before_[as_index(vertex)]; }
  /// The vertices whose faces are not known to be one fan, connected over edges around the vertex.
  [[nodiscard]] std::span<const std::int32_t> pinched() const { return pinched_; }

 private:
  void copy_shared_vertices(const OrderedSurface& mesh);
  void number_edges();
  void find_faces_of_vertices(const OrderedSurface& mesh);
  void find_pinched(const OrderedSurface& mesh, std::span<const std::int32_t> degrees);

  std::vector<OfFace> faces_;
  std::vector<Ends> ends_;
  std::vector<std::size_t> first_;  // per chunk, one more
  std::vector<Face> corners_;
  std::vector<std::int32_t> copied_, face_at_, before_, pinched_;
};

/// Those of a surface, which all surfaces of its connectivity share. May be called from several
/// threads.
[[nodiscard]] std::shared_ptr<const FaceEdges> face_edges_of(const OrderedSurface& mesh);

}  // namespace dapple
