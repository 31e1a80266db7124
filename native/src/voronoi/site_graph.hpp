// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// For each site, the sites whose cells touch its own: the edges of a Delaunay triangulation of the
/// plane or the torus.
struct SiteGraph {
  struct Link {
    std::int32_t site;  ///< j
    Vec3 offset;        ///< x_j - x_i; on the torus, of the image of j that touches
  };

  /// The links of a site in order of distance. Of coincident sites only the first has all; each of
  /// the others has one, to the first.
  [[nodiscard]] std::span<const Link> of(std::size_t site) const {
    return std::span(links).subspan(starts[site], starts[site + 1] - starts[site]);
  }

  std::vector<std::size_t> starts;  // rows of `links`, one more than sites
  std::vector<Link> links;
  bool periodic =
      false;  ///< cells are connected: no border separates a part of a cell from its site
};

/// The cells of the sites on a flat surface, or for a periodic graph on any flat surface that
/// covers the cells: as restricted_voronoi(surface, sites), with the neighbors known
/// and the integrals of the density times Surface::density_unit().
[[nodiscard]] RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                                   const SiteGraph& graph, Cells cells,
                                                   Context* context);

}  // namespace dapple
