// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <vector>

namespace dapple {

/// Cells in which samples are inserted and removed while some sites stay.
struct SharedCells {
  const std::vector<Moments>& cells;
  std::vector<bool> open;    ///< per cell: whether others may come into it
  std::vector<bool> locked;  ///< per cell: whether its site stays
};

/// The target capacity for `count` samples in the open cells. Locked samples in a crowd count as
/// one and leave the others more area. \pre an open cell has capacity, and the count is at least 1
[[nodiscard]] double capacity_for(const SharedCells& shared, std::size_t count);

/// The number of additional samples of that capacity that fit the open cells of locked sites.
[[nodiscard]] std::size_t lacking_beside_locked(const SharedCells& shared, double capacity);

/// The number of samples of that capacity that fit the open cells.
[[nodiscard]] double asked_for(const SharedCells& shared, double capacity);

}  // namespace dapple
