// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <dapple/tiles.hpp>

namespace dapple {

struct MosaicOptions {
  double grout = 0.0;
  std::vector<double> insets = {};  ///< per sample: how much farther its tile draws back; or empty
  double thickness = 0.0;
  double tolerance = 1e-3;
  bool merge = true;
  Cells cells = Cells::kConnected;
  int threads = 0;
};

inline constexpr std::tuple kMosaicOptions = {
    Option{
        "grout",
        &MosaicOptions::grout,
        {},
        "units of the surface",
        Level::kExpert,
        "Width of the gap between neighboring tiles, measured in space across the plane half-way "
        "between their sites; there is none where the surface ends."},
    Option{"thickness",
           &MosaicOptions::thickness,
           {},
           "units of the surface",
           Level::kExpert,
           "How far tiles rise along their normals, as closed bodies; 0: they lie in the surface."},
    Option{"tolerance",
           &MosaicOptions::tolerance,
           {},
           "spacings",
           Level::kExpert,
           "Edges of a tile that are shorter are removed."},
    Option{"merge",
           &MosaicOptions::merge,
           {},
           "",
           Level::kExpert,
           "Polygons of a tile in one plane become one."},
    cells_option(&MosaicOptions::cells),
    threads_option(&MosaicOptions::threads)};

constexpr const auto& options_of(const MosaicOptions&) { return kMosaicOptions; }

/// A mesh of polygons, the tiles one after another; tiles share no vertices. Every edge of a tile
/// lies between two of its polygons or on a loop, and polygons turn the way of the surface's faces.
struct Mosaic {
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> corners;  ///< vertex indices, polygon after polygon
  std::vector<std::int32_t> starts;   ///< where each polygon begins in corners, and their number
  std::vector<std::int32_t> sites;    ///< per polygon: the sample whose tile it is of
  std::vector<std::int32_t> classes;  ///< per polygon: the class of that sample
  std::vector<std::int32_t> faces;  ///< per polygon: a caller's face that it lies on or belongs to
  std::vector<TileSide> sides;      ///< per polygon; all kTop without thickness
  std::vector<Tile> tiles;          ///< per sample

  [[nodiscard]] std::size_t size() const { return sites.size(); }  ///< number of polygons
};

/// The restricted Voronoi cells of samples as tiles (paper, section 5.3 and Fig. 16a).
///
/// A tile is the part of its cell that is farther than half the grout (and its inset) from each
/// plane half-way to a neighbor; straight joints of constant width and exact on flat parts. A
/// border of a connected cell that lies in no such plane, since the straight way goes through a
/// wall, stays without grout. Where there is no grout at all, tiles that touch have the same points
/// where they do, bit by bit: closed, once vertices at the same place are one, where the surface
/// is closed.
/// \throw ArgumentError for an option below 0 or not finite, insets of another length than the
/// samples or the first of them that is negative; Cancelled
[[nodiscard]] Mosaic mosaic(const Surface& surface, const Samples& samples,
                            const MosaicOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
