// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Move sites on density 0 to the nearest point with density: no optimization step may lead there,
/// because a site without a cell has no gradient.
/// \param domain of the surface and its density
/// \param fixed per site, whether it stays where it is; empty: none
void lead_to_density(const Surface& surface, const Domain& domain, Sites& sites,
                     const std::vector<bool>& fixed = {});

/// Which sites continue if others can be inserted instead.
struct Led {
  std::vector<bool> fixed;  ///< per site, whether it stays where it is
  double reach = 0.0;       ///< of a site that is where the density is 0: it goes no farther
  bool keeps_one = false;   ///< whether the nearest of those goes on even if it is farther
};

/// Move sites on density 0 to the nearest point with density, if that is near.
/// \return the indices of all but those for which it is too far
/// \throw Cancelled
[[nodiscard]] std::vector<std::size_t> lead_near_ones(const Surface& surface, const Domain& domain,
                                                      Sites& sites, const Led& led,
                                                      const Context* context);

}  // namespace dapple
