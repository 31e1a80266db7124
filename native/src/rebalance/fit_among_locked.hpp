// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <vector>

namespace dapple {

/// Sites of another number, some of which stay.
struct FittedSites {
  std::vector<std::size_t> stay;  ///< indices of the sites that stay, in their order
  Sites fresh;                    ///< inserted sites; fewer than are missing if there are no places
  int evaluations = 0;            ///< of the cells
};

/// Remove sites that are crowded among locked ones, and insert new ones into the widest gaps.
/// \param sites  with barycentric coordinates, where there is density; at least one
/// \param locked per site: whether it stays
/// \param count  at least as many as are locked, and one
/// \throw Cancelled
[[nodiscard]] FittedSites fit_among_locked(const Surface& surface, const Domain& domain,
                                           const Sites& sites, const std::vector<bool>& locked,
                                           std::size_t count, std::uint64_t seed, Context* context);

}  // namespace dapple
