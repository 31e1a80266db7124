// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// The part of a cell left after moving the planes halfway to its neighbors by `width` toward its
/// site.
///
/// A neighbor counts only for pieces that end at its plane or before: with connected cells, a piece
/// can lie on the neighbor's side of the plane without belonging to its cell.
/// \param cell  all pieces of one cell
/// \param sites positions of all sites
[[nodiscard]] std::vector<CellPolygon> without_grout(std::span<const CellPolygon> cell,
                                                     std::span<const Vec3> sites, double width);

/// Area of a convex polygon.
[[nodiscard]] double area_of(const CellPolygon& piece);

}  // namespace dapple
