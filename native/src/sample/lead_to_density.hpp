// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Move sites on faces without density to the nearest place that has some: no step of an
/// optimization may lead there, as a site without a cell has no gradient.
/// \param domain of the surface and its density
/// \param fixed per site, whether it stays where it is; empty: none
void lead_to_density(const Surface& surface, const Domain& domain, Sites& sites,
                     const std::vector<bool>& fixed = {});

/// Whether a face has any density.
[[nodiscard]] bool has_density(const Surface& surface, std::int32_t face);

}  // namespace dapple
