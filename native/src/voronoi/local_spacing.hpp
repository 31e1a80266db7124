// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "base/hexagonal.hpp"

namespace dapple {

/// Hexagonal spacing where cells of a capacity have a cell's own density, averaged by itself: where
/// there is none, there is no room either.
inline double local_spacing(const Moments& cell, double capacity) {
  return hexagonal_spacing(cell.mass > 0.0 ? capacity * cell.capacity / cell.mass : 0.0);
}

}  // namespace dapple
