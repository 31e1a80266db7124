// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <span>
#include <vector>

#include "lines/feature_lines.hpp"
#include "remesh/cells_along.hpp"
#include "remesh/violations.hpp"

namespace dapple {

/// The dual of a restricted Voronoi diagram: a vertex for each site, a triangle where three cells
/// meet.
struct Dual {
  std::vector<Face> triangles;                     ///< of sites
  std::vector<Place> corners;                      ///< per triangle: where its cells meet
  std::vector<std::array<std::int32_t, 2>> lines;  ///< edges along lines, sorted, lower site first
  std::vector<Violation> violations;               ///< none: the mesh is as manifold as the surface
};

/// Lines divide cells into sheets, each of which is to be a disc: triangles then never cross a
/// line. \param kinds per site \throw Cancelled
[[nodiscard]] Dual dual_of(const Surface& surface, const FeatureLines& lines, const Sites& sites,
                           std::span<const SiteKind> kinds, Cells cells,
                           Context* context = nullptr);

/// The same, of cells by distances along the surface.
[[nodiscard]] Dual dual_of(const Surface& surface, const FeatureLines& lines, const Sites& sites,
                           std::span<const SiteKind> kinds, const CellsAlong& cells,
                           Context* context = nullptr);

/// Triangles of a polygon of sites, counter-clockwise, with the largest smallest angle.
void add_triangles(std::span<const std::int32_t> polygon, std::span<const Vec3> positions,
                   std::vector<Face>& triangles);

/// Find edges of two or more triangles that run in the same direction, where no line allows it. A
/// site where the cells of such a triangle meet mends it, at the farther one of two.
/// \param places per triangle: where its cells meet
/// \param positions and kinds: per site
void find_repeated_edges(std::span<const Face> triangles, std::span<const Place> places,
                         std::span<const Vec3> positions, std::span<const SiteKind> kinds,
                         std::vector<Violation>& violations);

}  // namespace dapple
