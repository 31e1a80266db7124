// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <span>
#include <vector>

#include "remesh/site_editor.hpp"

namespace dapple {

/// Triangles of a mesh that others take the place of.
struct MeshChange {
  std::vector<std::int32_t> gone;  ///< triangles
  std::vector<Face> made;
  /// Per triangle made, and per one gone: which of the sheets that lines divide the place into.
  std::vector<std::int32_t> made_sheets, gone_sheets;
};

/// A triangle mesh whose edges flip, collapse and split. Lines stay, and so does the topology:
/// around vertices and edges where the mesh is not manifold nothing changes.
class MeshEditor {
 public:
  /// \param sites the vertices, which must outlive it
  MeshEditor(const RemeshSites& sites, std::span<const Face> triangles,
             std::span<const std::array<std::int32_t, 2>> lines);

  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }
  [[nodiscard]] bool exists(std::int32_t t) const { return triangle(t)[0] >= 0; }
  [[nodiscard]] const Face& triangle(std::int32_t t) const { return triangles_[as_index(t)]; }
  /// The triangles at a vertex.
  [[nodiscard]] std::span<const std::int32_t> around(std::int32_t v) const {
    return around_[as_index(v)];
  }
  [[nodiscard]] bool is_line(std::int32_t a, std::int32_t b) const {
    return lines_.contains({std::min(a, b), std::max(a, b)});
  }
  /// The neighbors of a vertex along lines.
  [[nodiscard]] std::vector<std::int32_t> along_lines(std::int32_t v) const;
  [[nodiscard]] std::vector<std::int32_t> neighbors(std::int32_t v) const;

  /// The triangles at a vertex once more, for one that moves; none if they are no fan.
  [[nodiscard]] MeshChange moved(std::int32_t v) const;
  /// The other diagonal of the two triangles at an edge; none where it cannot be.
  [[nodiscard]] MeshChange flipped(std::int32_t a, std::int32_t b) const;
  /// Vertex `a` becomes one with `b`; none where that changes the topology or a line.
  [[nodiscard]] MeshChange collapsed(std::int32_t a, std::int32_t b) const;
  /// A new vertex on an edge that is no line; none where it cannot be.
  [[nodiscard]] MeshChange split(std::int32_t a, std::int32_t b, std::int32_t vertex) const;

  void apply(const MeshChange& change);
  /// Apply collapsed(a, b).
  void collapse(const MeshChange& change, std::int32_t a, std::int32_t b);

  [[nodiscard]] std::vector<Face> triangles() const;
  [[nodiscard]] std::vector<std::array<std::int32_t, 2>> lines() const {
    return {lines_.begin(), lines_.end()};
  }

 private:
  [[nodiscard]] std::vector<std::int32_t> fan(std::int32_t v) const;
  [[nodiscard]] std::int32_t beside(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] std::vector<std::int32_t> at_edge(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] bool may_collapse(std::int32_t a, std::int32_t b) const;

  const RemeshSites& sites_;
  std::vector<Face> triangles_;                    // -1 for those that are gone
  std::vector<std::vector<std::int32_t>> around_;  // per vertex
  std::set<std::array<std::int32_t, 2>> lines_;    // the lower vertex first
};

}  // namespace dapple
