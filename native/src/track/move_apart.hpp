// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>

namespace dapple {

/// Move sites apart that are too near to each other, and push those around them, along the surface.
/// Sites on two sides of a sheet are not near. Sites that are not in the way keep their positions.
/// \param least per site: its part of the distance that two sites keep, >= 0
/// \throw Cancelled
void move_apart(const Domain& domain, const std::vector<double>& least, Sites& sites,
                Context* context);

}  // namespace dapple
