// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "rebalance/rebalance.hpp"

namespace dapple {

/// Single sites to trade between places whose cells are too large and places whose cells are too
/// small, where that makes the capacities vary less. Such a place is a finger behind a narrow neck:
/// no site passes the neck, so all of its cells share what its whole number leaves. Neighborhoods
/// of a few sites, as rebalance() knows them, hold too little of it to be changed. \param diagram
/// the cells at a minimum, at least one of which has capacity
[[nodiscard]] Exchange find_trades(const RestrictedVoronoi& diagram);

}  // namespace dapple
