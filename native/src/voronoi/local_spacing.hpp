// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "base/hexagonal.hpp"

namespace dapple {

/// Hexagonal spacing of cells with a given capacity at a cell's own density, averaged over its
/// density: parts without density do not count.
inline double local_spacing(const Moments& cell, double capacity) {
  return hexagonal_spacing(cell.mass > 0.0 ? capacity * cell.capacity / cell.mass : 0.0);
}

}  // namespace dapple
