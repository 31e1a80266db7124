// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/moments.hpp>
#include <dapple/option.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace dapple {

/// The common boundary of a cell i with the cell of one neighbor j.
struct CellBoundary {
  std::int32_t neighbor;  ///< j
  /// a_ij = integral over the boundary of phi (x - x_i) / |x_j - x_i|_t ds, where |v|_t is the
  /// length of v in the plane of the face (paper, Theorem 2). It is the part of d|V_i|/dx_i due to
  /// j, and -d|V_j|/dx_i.
  Vec3 flux;
  Vec3 offset;         ///< x_j - x_i; on the torus, of the image of j that touches
  double length;       ///< integral of ds
  double path_length;  ///< shortest from x_i through the boundary to x_j; |offset| where that is
                       ///< straight
};

/// The Voronoi diagram of sites, restricted to a surface: V_i is the part of the surface nearer to
/// x_i than to any other site. Points at equal distance from coincident sites go to the lowest
/// index, whose twins stay empty.
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
  std::int32_t face;         ///< the caller's index
  std::vector<Vec3> points;  ///< counter-clockwise about the face's normal
  std::vector<std::int32_t>
      edges;  ///< what edge k (points k, k+1) lies on: site j >= 0, or face edge -1-corner
};

/// Which site owns a part of the surface that its nearest site in space does not reach along the
/// surface, because straight distance goes through walls: the other side of a sheet, a touching
/// finger, a body under a cloth.
enum class Cells {
  kConnected,  ///< one that it is connected to along the surface: cells follow the surface
  kEuclidean,  ///< the nearest in space, as in the paper
};

struct SidedSurface;

/// The two sides of thin walls, from elsewhere: those of another frame, or none.
using KnownSides = std::optional<std::shared_ptr<const SidedSurface>>;

constexpr std::array<Choice<Cells>, 2> choices_of(Cells) {
  return {{{"connected", Cells::kConnected}, {"euclidean", Cells::kEuclidean}}};
}

template <class Struct>
constexpr Option<Struct, Cells> cells_option(Cells Struct::*member) {
  return {"cells",
          member,
          {},
          "",
          Level::kExpert,
          "Which site a part of the surface belongs to: one that it is connected to along the "
          "surface, or the nearest in space, as in the paper."};
}

}  // namespace dapple
