// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/restricted_voronoi.hpp>

#include "base/progress.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/sides.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/cell_builder.hpp"
#include "voronoi/unit_voronoi.hpp"

namespace dapple {
namespace {

constexpr double kCut = 0.6;  // share of the progress of polygons when the cells are known

/// The surface with separated sides if cells are connected; otherwise the surface itself.
Surface in_sides(const Surface& surface, std::size_t count, Cells cells) {
  const auto sided = cells == Cells::kConnected ? with_sides(surface, count) : nullptr;
  return sided ? sided->all : surface;
}

}  // namespace

RestrictedVoronoi unit_voronoi(const Surface& surface, const Sites& sites, Cells cells,
                               Context* context) {
  RestrictedVoronoi result;
  CellBuilder(surface).build(sites, nullptr, cells, /*leaves_gaps=*/false, context, result);
  return result;
}

void remove_unit(RestrictedVoronoi& diagram, double density_unit) {
  if (density_unit == 1.0) return;
  const double once = 1.0 / density_unit;  // the square may overflow
  for (Moments& cell : diagram.cells) {
    cell.capacity *= once;
    cell.mass = cell.mass * once * once;
    cell.first = cell.first * once * once;
    cell.second = cell.second * once * once;
  }
  for (CellBoundary& side : diagram.boundaries) side.flux *= once;
}

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites, Cells cells,
                                     Context* context) {
  check_sites(surface, sites);
  RestrictedVoronoi diagram =
      unit_voronoi(in_sides(surface, sites.size(), cells), sites, cells, context);
  remove_unit(diagram, surface.ordered().density_unit());
  return diagram;
}

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                     const SiteGraph& graph, Cells cells, Context* context) {
  RestrictedVoronoi result;
  CellBuilder(surface).build(sites, &graph, cells, /*leaves_gaps=*/false, context, result);
  return result;
}

std::vector<CellPolygon> restricted_voronoi_polygons(const Surface& surface, const Sites& sites,
                                                     Cells cells, Context* context) {
  check_sites(surface, sites);
  Stretch cutting(context, 0.0, kCut), collecting(context, kCut, 1.0);
  const Surface sided = in_sides(surface, sites.size(), cells);
  CellBuilder builder(sided);
  RestrictedVoronoi diagram;
  builder.build_by_floods(sites, nullptr, cells, /*leaves_gaps=*/false, cutting.context(), diagram);
  return builder.polygons(collecting.context());
}

}  // namespace dapple
