// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/sets.hpp"
#include "surface/face_edges.hpp"

namespace dapple {

/// The faces that cells extend over during an optimization, where some faces have no density: those
/// with density, and those so near it that sites on both sides of a gap repel each other across it.
/// Sites would look for all faces beyond, which count for nothing.
class DensitySupport {
 public:
  /// \param edges those of the surface
  /// \param count the number of sites, from which spacings follow
  DensitySupport(const Surface& surface, const FaceEdges& edges, std::size_t count);

  [[nodiscard]] bool has(OrderedFace face) const { return faces_[as_index(face)] != 0; }
  [[nodiscard]] std::size_t face_count() const { return face_count_; }

  /// The part that a vertex of FaceEdges is in, from 0 on; -1 if it has no face here. Two parts
  /// have no vertex in common.
  [[nodiscard]] std::int32_t part(std::int32_t vertex) const { return parts_[as_index(vertex)]; }
  [[nodiscard]] std::size_t part_count() const { return part_count_; }

  /// Per edge of a chunk of faces, whether a face of the chunk that is here has it.
  /// \param edges as given to the constructor
  [[nodiscard]] std::span<const char> edges(const FaceEdges& edges, std::size_t chunk) const {
    return std::span(edges_).subspan(edges.first_edge(chunk), edges.edges(chunk).size());
  }

  /// The vertices whose faces here are not connected over edges around the vertex, where those of
  /// the surface are.
  [[nodiscard]] std::span<const std::int32_t> pinched() const { return pinched_; }

 private:
  void add_faces_near_density(const Surface& surface, const FaceEdges& edges, Sets& joined,
                              std::size_t count);
  void number_parts(const FaceEdges& edges, Sets sets);
  void find_edges(const FaceEdges& edges);
  void find_pinched(const OrderedSurface& mesh, const FaceEdges& edges);

  std::vector<char> faces_;
  std::size_t face_count_ = 0, part_count_ = 0;
  std::vector<std::int32_t> parts_;  // per vertex
  std::vector<char> edges_;          // of all chunks
  std::vector<std::int32_t> pinched_;
};

}  // namespace dapple
