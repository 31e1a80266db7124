// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

namespace dapple {

/// What is left of a cell when the planes half-way to its neighbors move `width` toward its site.
///
/// A neighbor counts on the pieces that end at its plane or before; where cells are connected, one
/// that shares a border elsewhere can have the piece on its own side without owning it.
/// \param cell  all pieces of one cell
/// \param sites positions of all sites
[[nodiscard]] std::vector<CellPolygon> without_grout(std::span<const CellPolygon> cell,
                                                     std::span<const Vec3> sites, double width);

/// Area of a convex polygon.
[[nodiscard]] double area_of(const CellPolygon& piece);

}  // namespace dapple
