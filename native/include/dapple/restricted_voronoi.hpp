// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/context.hpp>
#include <dapple/moments.hpp>
#include <dapple/option.hpp>
#include <dapple/surface.hpp>
#include <dapple/types.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace dapple {

/// The common boundary of the cells of two neighbors i and j.
struct CellBoundary {
  std::int32_t neighbor;  ///< j
  /// a_ij = integral over the boundary of phi (x - x_i) / |x_j - x_i|_t ds, where |v|_t is the
  /// length of v in the plane of the face (paper, Theorem 2). It is the contribution of j to
  /// d|V_i|/dx_i, and equals -d|V_j|/dx_i.
  Vec3 flux;
  Vec3 offset;         ///< x_j - x_i; on the torus, for the periodic image of j that touches
  double length;       ///< integral of ds
  double path_length;  ///< length of the shortest path from x_i through the boundary to x_j;
                       ///< |offset| where it is straight
};

/// The Voronoi diagram of sites, restricted to a surface: V_i is the part of the surface nearer to
/// x_i than to any other site. Of coincident sites the one of lowest index gets the cell, and the
/// others stay empty.
struct RestrictedVoronoi {
  std::vector<Moments> cells;  ///< per site, relative to the site

  /// The boundaries of cell `site`, in a fixed order.
  /// \pre site < cells.size()
  [[nodiscard]] std::span<const CellBoundary> boundary(std::size_t site) const {
    return std::span(boundaries).subspan(rows[site].first, rows[site].count);
  }

  struct Row {
    std::size_t first = 0;
    std::size_t count = 0;
  };
  std::vector<Row> rows;
  std::vector<CellBoundary> boundaries;
};

/// One convex piece of a cell: the part of a face that belongs to a site.
struct CellPolygon {
  std::int32_t site;
  std::int32_t face;                ///< the caller's index
  std::vector<Vec3> points;         ///< counter-clockwise about the face's normal
  std::vector<std::int32_t> edges;  ///< what edge k (points k, k+1) lies on: the bisector with site
                                    ///< j >= 0, or the face's edge -1-corner
};

/// Who owns a part of the surface whose nearest site in space lies beyond a wall: on the other side
/// of a sheet, on a touching finger, on a body under a cloth.
enum class Cells {
  kConnected,  ///< a site that it is connected to along the surface: cells follow the surface
  kEuclidean,  ///< the nearest in space, as in the paper
};

struct SidedSurface;

/// The two sides of thin walls, where they are known from another frame; or none.
using KnownSides = std::optional<std::shared_ptr<const SidedSurface>>;

/// Compute all cells, each on its own and in parallel: flood over the mesh from the face that holds
/// the site, and clip each face by the bisectors with the site's neighbors in order of distance,
/// until the next neighbor is farther than twice the farthest corner of what is left (the security
/// radius). Faces that no flood covers are then assigned by the rule of `cells`, so that every unit
/// of area belongs to exactly one site.
/// \pre the sites lie on their faces
/// \throw ArgumentError naming the first site that is not finite or whose face is out of range;
/// Cancelled
[[nodiscard]] RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                                   Cells cells = Cells::kConnected,
                                                   Context* context = nullptr);

/// The same cells as polygons, sorted by site; memory grows with the number of pieces.
/// \pre, \throw as restricted_voronoi()
[[nodiscard]] std::vector<CellPolygon> restricted_voronoi_polygons(const Surface& surface,
                                                                   const Sites& sites,
                                                                   Cells cells = Cells::kConnected,
                                                                   Context* context = nullptr);

}  // namespace dapple
