// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <dapple/context.hpp>
#include <unordered_map>

#include "voronoi/cell_flood.hpp"

namespace dapple {

/// Which cells lie beside which, and over which faces they go: known of those that are asked for
/// alone, at the price of these. All sites are the caller's.
class Rings {
 public:
  /// \param surface must outlive the rings
  Rings(const Surface& surface, const Sites& sites);

  /// The sites whose cells have a part of one of the faces; sorted.
  /// \param faces sorted
  /// \throw Cancelled
  [[nodiscard]] std::vector<std::int32_t> owners(std::span<const OrderedFace> faces,
                                                 const Context* context);

  /// The sites and those beside them; sorted.
  /// \param sites sorted
  /// \throw Cancelled
  [[nodiscard]] std::vector<std::int32_t> grown(std::span<const std::int32_t> sites,
                                                const Context* context);

  /// The faces that the cells of sites have a part of; sorted.
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
