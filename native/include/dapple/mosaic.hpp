// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// The tile of one cell.
///
/// A tile follows the surface over faces and creases. Most tiles have one part and one loop. A hole
/// of the surface in the cell, or another cell inside it, adds a loop; a cell that is a whole
/// closed component has no loop, and with a thickness it becomes a shell. Grout can cut a narrow
/// cell into several parts, or leave nothing of it.
struct Tile {
  double cell_area = 0.0;  ///< of the cell
  double area = 0.0;       ///< of the part that the grout leaves, with welded vertices
  std::int32_t parts = 0;  ///< pieces connected over edges
  std::int32_t loops = 0;  ///< closed borders, over all parts
};

/// Which face of a tile a polygon is.
enum class TileSide : std::int32_t { kTop, kWall, kBottom };

struct MosaicOptions {
  /// Width of the gap between neighboring tiles, measured across the bisector of their sites; there
  /// is no gap at borders of the surface.
  double grout = 0.0;  // expert, >= 0, units of the surface
  /// Thickness of tiles along their normals, as closed bodies; 0 leaves them flat in the surface.
  double thickness = 0.0;  // expert, >= 0, units of the surface
  /// Shorter edges of a tile are removed.
  double shortest_edge = 1e-3;  // expert, >= 0, spacings
  /// Merge the polygons of a tile that lie in one plane.
  bool merge = true;  // expert
  /// Owner of a part of the surface: the nearest site that it is connected to along the surface, or
  /// the nearest site in space as in the paper.
  Cells cells = Cells::kConnected;  // expert
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  std::vector<double> insets =
      {};  ///< per sample: additional distance of its tile from the borders of the cell; or empty
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const MosaicOptions& options);

/// A mesh of polygons, tile after tile; tiles share no vertices. Every edge of a tile lies between
/// two of its polygons or on a loop, and polygons are oriented like the surface's faces.
struct Mosaic {
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> corners;  ///< vertex indices, polygon after polygon
  std::vector<std::int32_t>
      starts;  ///< where each polygon begins in `corners`, and at the end the length of `corners`
  std::vector<std::int32_t> sites;    ///< per polygon: the sample of its tile
  std::vector<std::int32_t> classes;  ///< per polygon: the class of that sample
  std::vector<std::int32_t>
      faces;                    ///< per polygon: the caller's face that it lies on or belongs to
  std::vector<TileSide> sides;  ///< per polygon; all kTop without thickness
  std::vector<Tile> tiles;      ///< per sample

  [[nodiscard]] std::size_t size() const { return sites.size(); }  ///< number of polygons
};

/// The restricted Voronoi cells of samples as tiles (paper, section 5.3 and Fig. 16a).
///
/// A tile is the part of its cell that is farther than half the grout (plus its inset) from each
/// plane halfway to a neighbor, which gives straight joints of constant width, exact on flat parts.
/// A border of a connected cell that lies in no such plane, because the straight line goes through
/// a wall, gets no grout. Without any grout, neighboring tiles share the exact coordinates of their
/// common points, so that merging coincident vertices closes the mosaic of a closed surface.
/// \throw ArgumentError for an option below 0 or not finite, insets of another length than the
/// samples or the first of them that is negative; Cancelled
[[nodiscard]] Mosaic mosaic(const Surface& surface, const Samples& samples,
                            const MosaicOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
