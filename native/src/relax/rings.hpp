// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <dapple/context.hpp>
#include <unordered_map>

#include "voronoi/cell_flood.hpp"

namespace dapple {

/// Adjacency of cells and the faces that they cover, computed only for the cells that are asked
/// for. All sites are the caller's.
class Rings {
 public:
  /// \param surface must outlive the rings
  Rings(const Surface& surface, const Sites& sites);

  /// The sites whose cells overlap one of the faces; sorted.
  /// \param faces sorted
  /// \throw Cancelled
  [[nodiscard]] std::vector<std::int32_t> owners(std::span<const OrderedFace> faces,
                                                 const Context* context);

  /// The sites and their neighbors; sorted.
  /// \param sites sorted
  /// \throw Cancelled
  [[nodiscard]] std::vector<std::int32_t> grown(std::span<const std::int32_t> sites,
                                                const Context* context);

  /// The faces that the sites' cells overlap; sorted.
  /// \throw Cancelled
  [[nodiscard]] std::vector<OrderedFace> faces(std::span<const std::int32_t> sites,
                                               const Context* context);

 private:
  struct Cell {
    std::vector<std::int32_t> neighbors;
    std::vector<OrderedFace> faces;
  };

  [[nodiscard]] std::vector<std::int32_t> on_or_near(std::span<const OrderedFace> faces) const;
  void find(std::span<const std::int32_t> sites, const Context* context);
  [[nodiscard]] Cell find_cell(CellFlood& flood, std::int32_t site) const;

  [[nodiscard]] std::int32_t ordered(std::int32_t site) const {
    return ordered_[static_cast<std::size_t>(site)];
  }

  const Surface& surface_;
  OrderedSites sites_;
  SiteIndex index_;
  std::vector<std::int32_t> ordered_;  // caller's -> ordered
  tbb::enumerable_thread_specific<CellFlood> floods_;
  std::unordered_map<std::int32_t, Cell> cells_;  // those found so far
};

}  // namespace dapple
