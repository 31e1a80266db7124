// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <vector>

namespace dapple {

/// Cells among which samples come and go, some of whose sites stay where they are.
struct SharedCells {
  const std::vector<Moments>& cells;
  std::vector<bool> open;    ///< per cell: whether others may come into it
  std::vector<bool> locked;  ///< per cell: whether its site stays
};

/// The capacity that each sample is to have for `count` samples in the open cells. Locked samples
/// in a crowd share one place and leave the others more room.
/// \pre an open cell has capacity, and the count is at least 1
[[nodiscard]] double capacity_for(const SharedCells& shared, std::size_t count);

/// How many more samples of that capacity the open cells of locked sites have room for.
[[nodiscard]] std::size_t lacking_beside_locked(const SharedCells& shared, double capacity);

/// How many samples of that capacity the open cells ask for.
[[nodiscard]] double asked_for(const SharedCells& shared, double capacity);

}  // namespace dapple
