// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace dapple {

/// What became of one cell.
///
/// A tile follows the surface over faces and creases. Most have one part and one loop; a hole of
/// the surface in the cell, or another cell inside it, adds a loop; a cell that is a whole closed
/// component has none, and with a thickness it becomes a shell; narrow places of a cell can be lost
/// to the grout, which adds parts; a cell that it fills has no part at all.
struct Tile {
  double cell_area = 0.0;  ///< of the cell
  double area = 0.0;       ///< of what the grout leaves of it, its vertices being welded
  std::int32_t parts = 0;  ///< pieces connected over edges
  std::int32_t loops = 0;  ///< closed borders, over all parts
};

/// Which face of a tile a polygon is.
enum class TileSide : std::int32_t { kTop, kWall, kBottom };

}  // namespace dapple
