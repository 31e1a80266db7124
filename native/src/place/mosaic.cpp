// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <dapple/mosaic.hpp>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "base/validate.hpp"
#include "place/grout.hpp"
#include "place/patch.hpp"
#include "place/tile.hpp"
#include "sample/validate_samples.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 32;   // cells per chunk
constexpr double kRounding = 1e-9;   // spacings: shorter edges are rounding errors
constexpr double kSamePlace = 1e-6;  // spacings: copies of a point in two tiles are closer
// Shares of the progress when large faces are cut, the cells are known, and the tiles are made.
constexpr double kCut = 0.15, kCellsShare = 0.4;
constexpr double kMade = 0.95;

void check(const Surface& surface, const Samples& samples, const MosaicOptions& options) {
  check_samples(surface, samples);
  check_options(options);
  if (options.insets.empty()) return;
  check_same_length("insets", options.insets.size(), "samples", samples.size());
  for (std::size_t k = 0; k < options.insets.size(); ++k)
    check_at_least(entry("insets", k).c_str(), options.insets[k], 0.0);
}

/// A tile before all tiles are merged into one mesh.
struct MadeTile {
  TileMesh mesh;
  Tile tile;
};

class Tiler {
 public:
  Tiler(const Surface& surface, const Samples& samples, const MosaicOptions& options)
      : vertices_(surface.vertices()),
        faces_(surface.welded_faces()),
        builder_(vertices_, faces_),
        samples_(samples),
        options_(options),
        rounding_(kSamePlace * surface.spacing(samples.size())),
        shortest_(std::max(options.shortest_edge, kRounding) * surface.spacing(samples.size())) {}

  [[nodiscard]] bool merges() const { return options_.merge; }

  /// Whether tiles touch, except where insets separate them.
  [[nodiscard]] bool touch() const { return options_.grout == 0.0; }

  /// The part of a cell that is not covered by grout.
  [[nodiscard]] JoinedPatch join(std::size_t site, std::span<const CellPolygon> cell,
                                 const EdgePoints& others) const {
    const double inset = options_.insets.empty() ? 0.0 : options_.insets[site];
    return builder_.build(without_grout(cell, samples_.positions, 0.5 * options_.grout + inset),
                          others);
  }

  /// Points on edges of the mesh along which touching tiles can have borders; empty if tiles do not
  /// touch.
  [[nodiscard]] EdgePoints edge_points(std::span<const CellPolygon> pieces) const {
    return touch() ? builder_.edge_points(pieces) : EdgePoints();
  }

  [[nodiscard]] Patch cleaned(JoinedPatch joined) const {
    return without_short_edges(std::move(joined), shortest_);
  }

  /// Clean the patches, all together if tiles touch each other.
  [[nodiscard]] std::vector<Patch> cleaned(std::vector<JoinedPatch> joined) const {
    return without_short_edges(std::move(joined), shortest_, std::min(shortest_, rounding_));
  }

  [[nodiscard]] MadeTile make(std::span<const CellPolygon> cell, const Patch& patch,
                              FlatPatch flat) const {
    MadeTile result;
    for (const CellPolygon& piece : cell) result.tile.cell_area += area_of(piece);
    for (const PatchPolygon& polygon : patch.polygons)
      result.tile.area += 0.5 * twice_area_vector(patch, polygon).norm();
    result.tile.parts = flat.topology.parts;
    result.tile.loops = flat.topology.loops;
    result.mesh = raised(without_straight(std::move(flat)), options_.thickness);
    return result;
  }

 private:
  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;
  PatchBuilder builder_;
  const Samples& samples_;
  const MosaicOptions& options_;
  double rounding_, shortest_;
};

/// The index of each site's first piece, and the number of pieces.
std::vector<std::size_t> rows_of(std::span<const CellPolygon> pieces, std::size_t sites) {
  std::vector<std::size_t> result(sites + 1, 0);
  for (const CellPolygon& piece : pieces) ++result[static_cast<std::size_t>(piece.site) + 1];
  std::partial_sum(result.begin(), result.end(), result.begin());
  return result;
}

void append(Mosaic& mosaic, std::int32_t site, std::int32_t kind, const MadeTile& made) {
  const auto first = static_cast<std::int32_t>(mosaic.vertices.size());
  const Patch& patch = made.mesh.patch;
  mosaic.vertices.insert(mosaic.vertices.end(), patch.points.begin(), patch.points.end());
  for (const auto& [corners, face] : patch.polygons) {
    for (const std::int32_t v : corners) mosaic.corners.push_back(first + v);
    mosaic.starts.push_back(static_cast<std::int32_t>(mosaic.corners.size()));
    mosaic.sites.push_back(site);
    mosaic.classes.push_back(kind);
    mosaic.faces.push_back(face);
  }
  mosaic.sides.insert(mosaic.sides.end(), made.mesh.sides.begin(), made.mesh.sides.end());
  mosaic.tiles.push_back(made.tile);
}

/// Maps polygons from pieces to the caller's faces.
void name_parents(const CutSurface& cut, std::span<MadeTile> tiles) {
  for (MadeTile& made : tiles)
    for (PatchPolygon& polygon : made.mesh.patch.polygons) polygon.face = cut.parent(polygon.face);
}

/// The corners of touching tiles. They are shared so that no corner of one tile lies inside an edge
/// of another.
class Corners {
 public:
  explicit Corners(std::span<const FlatPatch> tiles) {
    for (const FlatPatch& tile : tiles)
      for (const PatchPolygon& polygon : tile.patch.polygons)
        for (const std::int32_t v : kept_corners(tile, polygon))
          points_.push_back(key(tile.patch.points[static_cast<std::size_t>(v)]));
    sort_unique(points_);
  }

  [[nodiscard]] bool has(const Vec3& point) const {
    return std::ranges::binary_search(points_, key(point));
  }

 private:
  using Key = std::array<double, 3>;
  static Key key(const Vec3& point) { return {point[0], point[1], point[2]}; }
  std::vector<Key> points_;
};

/// Keep the vertices of touching tiles that are corners of others.
void share_corners(std::span<FlatPatch> tiles) {
  const Corners corners(tiles);
  parallel_chunks(tiles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (FlatPatch& tile : tiles.subspan(begin, end - begin))
      for (std::size_t v = 0; v < tile.straight.size(); ++v)
        if (tile.straight[v]) tile.straight[v] = !corners.has(tile.patch.points[v]);
  });
}

std::vector<MadeTile> made_of(const Tiler& tiler, std::span<const CellPolygon> pieces,
                              std::span<const std::size_t> rows, Context* context) {
  const std::size_t count = rows.size() - 1;
  const auto cell = [&](std::size_t k) { return pieces.subspan(rows[k], rows[k + 1] - rows[k]); };
  Tally tally(context, 2 * count);
  const auto for_each = [&](const auto& work) {
    parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
      tally.check();
      for (std::size_t k = begin; k < end; ++k) work(k);
      tally.add(end - begin);
    });
  };
  std::vector<JoinedPatch> joined(count);
  std::vector<Patch> patches(count);
  std::vector<FlatPatch> flat(count);
  std::vector<MadeTile> result(count);
  const EdgePoints others = tiler.edge_points(pieces);
  for_each([&](std::size_t k) {
    joined[k] = tiler.join(k, cell(k), others);
    if (!tiler.touch()) patches[k] = tiler.cleaned(std::move(joined[k]));
  });
  if (tiler.touch()) patches = tiler.cleaned(std::move(joined));
  for_each([&](std::size_t k) {
    patches[k] = apart(patches[k]);
    flat[k] = flattened(patches[k], tiler.merges());
  });
  if (tiler.merges() && tiler.touch()) share_corners(flat);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      result[k] = tiler.make(cell(k), patches[k], std::move(flat[k]));
      patches[k] = {};  // here, because freeing all at once takes 0.1 s
    }
  });
  return result;
}

std::vector<MadeTile> make_tiles(const Surface& surface, const Samples& samples,
                                 const MosaicOptions& options, Context* context) {
  Sites sites;
  sites.positions = samples.positions;
  sites.faces = samples.faces;
  Stretch cutting(context, 0.0, kCut);
  const CellSurface on = cell_surface(surface, sites.size(), options.cells, cutting.context());
  const std::shared_ptr<const CutSurface>& cut = on.cut;
  const Surface& drawn = cut ? cut->surface() : on.uncut(surface);
  Stretch dividing(context, cut ? kCut : 0.0, kCellsShare);
  const std::vector<CellPolygon> pieces = restricted_voronoi_polygons(
      drawn, cut ? cut->on_pieces(sites) : sites, options.cells, dividing.context());
  const std::vector<std::size_t> rows = rows_of(pieces, samples.size());
  const Tiler tiler(drawn, samples, options);
  Stretch making(context, kCellsShare, kMade);
  std::vector<MadeTile> tiles = made_of(tiler, pieces, rows, making.context());
  if (cut) name_parents(*cut, tiles);
  return tiles;
}

}  // namespace

Mosaic mosaic(const Surface& surface, const Samples& samples, const MosaicOptions& options,
              Context* context) {
  check(surface, samples, options);
  if (context) context->check();
  const std::vector<MadeTile> tiles =
      with_threads(options.threads, [&] { return make_tiles(surface, samples, options, context); });
  Mosaic result;
  result.starts.push_back(0);
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    check_at(context, k, 256);
    append(result, static_cast<std::int32_t>(k), samples.classes[k], tiles[k]);
  }
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
