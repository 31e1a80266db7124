// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/cells.hpp>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Compute all cells, one at a time and in parallel: from the face that holds the site, flood over
/// the mesh, clipping each face by the bisectors with the site's neighbors in order of distance
/// until the next one is farther than twice the farthest corner of what is left (the security
/// radius). Faces that the floods leave uncovered are then given away by the rule of `cells`, so
/// that every unit of area belongs to exactly one site.
/// \pre the sites lie on their faces
/// \throw ArgumentError naming the first site that is not finite or whose face is out of range;
/// Cancelled
[[nodiscard]] RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                                   Context* context = nullptr,
                                                   Cells cells = Cells::kEuclidean);

/// The same cells as polygons, sorted by site; memory grows with the number of pieces.
/// \pre, \throw as restricted_voronoi()
[[nodiscard]] std::vector<CellPolygon> restricted_voronoi_polygons(const Surface& surface,
                                                                   const Sites& sites,
                                                                   Cells cells = Cells::kEuclidean,
                                                                   Context* context = nullptr);

}  // namespace dapple
