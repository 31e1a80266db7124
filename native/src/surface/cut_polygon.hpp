// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Triangulates a polygon, which may be concave and need not be planar; each triangle
/// is three indices into `corners`, in the polygon's sense.
///
/// Convex polygons become fans from their first corner. Others get a constrained Delaunay
/// triangulation in their best plane; if edges cross there, the triangulation of
/// the least area (Klincsek 1980). Corners that repeat a place may remain unused.
[[nodiscard]] std::vector<std::array<std::int32_t, 3>> cut_polygon(std::span<const Vec3> corners);

}  // namespace dapple
