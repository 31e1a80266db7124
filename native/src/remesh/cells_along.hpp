// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <vector>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// Cells by distances along the surface, which know nothing of other walls close by: cells in space
/// reach through walls thinner than themselves. Squared distances are measured at the corners of
/// the faces and are linear in between, up to what all sites have in common. On a flat part the
/// cells are those in space therefore. Faces are to be smaller than cells.
class CellsAlong {
 public:
  /// \param surface must outlive it
  explicit CellsAlong(const Surface& surface);

  /// \throw Cancelled
  [[nodiscard]] std::vector<CellPolygon> polygons(const Sites& sites,
                                                  Context* context = nullptr) const;

 private:
  class Flood;
  /// How far a node is from a site.
  struct Distance {
    std::int32_t site = -1;
    double squared = 0.0;
  };
  /// The distances at each node, by site.
  struct Table {
    std::vector<std::size_t> rows;  // per node, one more
    std::vector<Distance> values;

    [[nodiscard]] std::span<const Distance> at(std::int32_t node) const {
      return std::span(values).subspan(rows[as_index(node)],
                                       rows[as_index(node) + 1] - rows[as_index(node)]);
    }
  };

  void find_nodes();
  void index_corners();
  [[nodiscard]] std::size_t node_count() const { return rows_.size() - 1; }
  [[nodiscard]] std::span<const std::int32_t> corners_at(std::int32_t node) const {
    return std::span(corners_).subspan(rows_[as_index(node)],
                                       rows_[as_index(node) + 1] - rows_[as_index(node)]);
  }
  [[nodiscard]] std::int32_t node(std::int32_t corner) const { return nodes_[as_index(corner)]; }
  [[nodiscard]] const Vec3& position(std::int32_t node) const {
    return mesh_.vertex(
        mesh_.corners(face_of(first_corner(node)))[as_index(first_corner(node) % 3)]);
  }
  [[nodiscard]] std::int32_t first_corner(std::int32_t node) const {
    return corners_[rows_[as_index(node)]];
  }
  [[nodiscard]] std::vector<std::int32_t> start_of_flood(const Sites& sites,
                                                         std::size_t site) const;
  [[nodiscard]] std::vector<double> nearest(const Sites& sites, Context* context) const;
  [[nodiscard]] Table measure(const Sites& sites, Context* context) const;
  [[nodiscard]] std::vector<std::int32_t> owners_of_components(const Sites& sites) const;
  void divide(OrderedFace face, const Table& table, std::vector<CellPolygon>& result) const;

  const Surface& surface_;
  const OrderedSurface& mesh_;
  std::vector<std::int32_t> nodes_;    // per corner: the fan of faces around a vertex
  std::vector<std::size_t> rows_;      // per node, one more: of corners_
  std::vector<std::int32_t> corners_;  // half-edges that start there
  std::vector<double> reach_;          // per node: its longest edge
};

}  // namespace dapple
