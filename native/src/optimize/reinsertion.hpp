// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/objective.hpp"

namespace dapple {

/// New positions for sites without capacity: they coincide with another, met one in a corner, or
/// left the density's support. They have no gradient, so no step would ever move them.
///
/// Each goes halfway from the site with the largest cell nearby (that of its nearest neighbor with
/// a cell, or one beside it) to that one's farthest neighbor, or into the open where there is
/// none. Two never go to the same place.
/// \return indices of the sites and their new, not yet
/// projected positions and hints; empty if every site has a cell
struct Reinsertion {
  std::vector<std::int32_t> sites;
  Vectors positions;
  std::vector<std::int32_t> faces;  ///< of the site that each starts from
};
[[nodiscard]] Reinsertion find_reinsertion(const Objective& objective, const Evaluation& state);

/// Whether a movable site has no capacity, in the union or its class.
[[nodiscard]] bool has_empty_cell(const Objective& objective, const Evaluation& state);

}  // namespace dapple
