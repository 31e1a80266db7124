// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <dapple/restricted_voronoi.hpp>
#include <numeric>
#include <optional>

#include "base/laps.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/cell_integrals.hpp"
#include "voronoi/shared_faces.hpp"
#include "voronoi/unit_voronoi.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 32;  // cells a chunk

// Of the progress: the cells are known but for the uncovered faces, which are in few of them or in
// many.
constexpr double kFlooded = 0.7;
constexpr double kCut = 0.6;  // of that of polygons: the cells are known

class Builder {
 public:
  Builder(const Surface& surface, const Sites& sites, const SiteGraph* graph, Cells cells,
          Context* context)
      : surface_(surface),
        sites_(in_stage(context, Stage::kNeighbors, [&] { return OrderedSites(surface, sites); })),
        index_(in_stage(context, Stage::kNeighbors, [&] { return SiteIndex(sites_, graph); })),
        whole_(graph && graph->periodic),
        connected_(cells == Cells::kConnected),
        context_(context),
        floods_([this] { return CellFlood(surface_, sites_, index_); }) {}

  RestrictedVoronoi build() {
    result_.cells.resize(count());
    result_.rows.resize(count());
    std::vector<std::int32_t> all(count());
    std::iota(all.begin(), all.end(), 0);
    Stretch flooding(context_, 0.0, whole_ ? 1.0 : kFlooded), mending(context_, kFlooded, 1.0);
    integrate(all, flooding.context());
    if (!whole_ && missing_area()) share_uncovered_faces(mending.context());
    if (context_) context_->advance(1.0);
    pieces_.clear();
    return std::move(result_);
  }

  /// Of cells that are built.
  std::vector<CellPolygon> polygons(Context* context) {
    std::vector<std::vector<CellPolygon>> cells(count());
    Tally tally(context, count());
    parallel_chunks(count(), kGrain, [&](std::size_t begin, std::size_t end) {
      tally.check();
      for (std::size_t s = begin; s < end; ++s)
        collect(static_cast<std::int32_t>(s), cells[original(static_cast<std::int32_t>(s))]);
      tally.add(end - begin);
    });
    std::vector<CellPolygon> result;
    for (auto& cell : cells) std::move(cell.begin(), cell.end(), std::back_inserter(result));
    return result;
  }

 private:
  [[nodiscard]] std::size_t count() const { return sites_.size(); }

  /// A site's shares of uncovered faces, as a range of shares_.
  [[nodiscard]] std::span<const Share> shares_of(std::int32_t site) const {
    const auto first =
        std::lower_bound(shares_.begin(), shares_.end(), Share{site, OrderedFace{-1}});
    const auto last = std::lower_bound(first, shares_.end(), Share{site + 1, OrderedFace{-1}});
    return {first, last};
  }

  /// Call `visit(face, whole)` for each piece of the site's cell, and `flush()` after each change
  /// of bisectors. Uncovered faces with owners are divided among these; what floods found there is
  /// void.
  template <typename Visit, typename Flush>
  void for_each_piece(CellFlood& flood, std::int32_t site, const Visit& visit, const Flush& flush) {
    if (!flood.reset(site)) return;
    flood.flood(starts(site), [&](OrderedFace face, bool whole) {
      if (!is_divided(face)) visit(face, whole);
    });
    flush();
    if (!connected_) return;
    for (const Share& share : shares_of(site)) {
      flood.reset_among(site, owners_of(share.face));
      const bool whole = flood.clip(share.face);
      if (flood.polygon().empty()) continue;
      visit(share.face, whole);
      flush();
    }
  }

  /// The faces to flood a Euclidean cell from; a connected one is flooded from its site alone.
  [[nodiscard]] std::vector<OrderedFace> starts(std::int32_t site) const {
    std::vector<OrderedFace> faces = {sites_.faces[static_cast<std::size_t>(site)]};
    if (!connected_)
      for (const Share& share : shares_of(site)) faces.push_back(share.face);
    return faces;
  }

  [[nodiscard]] bool is_divided(OrderedFace face) const {
    return connected_ && !divided_.empty() && !owners_of(face).empty();
  }
  [[nodiscard]] std::span<const std::int32_t> owners_of(OrderedFace face) const {
    const auto f = as_index(face);
    return std::span(owners_).subspan(divided_[f], divided_[f + 1] - divided_[f]);
  }

  void integrate(std::span<const std::int32_t> sites, Context* context) {
    const std::size_t chunks = (sites.size() + kGrain - 1) / kGrain;
    std::vector<std::vector<CellBoundary>> boundaries(chunks);
    pieces_.assign(chunks, {});
    Tally tally(context, sites.size());
    std::optional<SharedLoop> loop(std::in_place, context_, Stage::kNeighbors);
    parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      tally.check();
      const std::size_t chunk = begin / kGrain;
      loop->run(chunk, floods_.local().laps(), [&] {
        integrate_chunk(sites.subspan(begin, end - begin), boundaries[chunk], pieces_[chunk]);
      });
      tally.add(end - begin);
    });
    loop.reset();
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      for (const std::int32_t s :
           sites.subspan(chunk * kGrain).first(std::min(kGrain, sites.size() - chunk * kGrain)))
        row(s).first += result_.boundaries.size();
      result_.boundaries.insert(result_.boundaries.end(), boundaries[chunk].begin(),
                                boundaries[chunk].end());
    }
  }

  void integrate_chunk(std::span<const std::int32_t> sites, std::vector<CellBoundary>& boundaries,
                       std::vector<Coverage>& pieces) {
    CellFlood& flood = floods_.local();
    CellIntegrals integrals(surface_, flood);
    std::vector<CellBoundary> boundary;
    for (const std::int32_t s : sites) {
      integrals.reset();
      boundary.clear();
      for_each_piece(
          flood, s,
          [&](OrderedFace face, bool whole) {
            const double before = integrals.moments().area;
            integrals.add(face, whole);
            pieces.push_back({s, face, integrals.moments().area - before});
          },
          [&] { integrals.flush_boundary(sites_, boundary); });
      row(s) = {boundaries.size(), boundary.size()};
      boundaries.insert(boundaries.end(), boundary.begin(), boundary.end());
      result_.cells[original(s)] = integrals.moments();
    }
  }

  [[nodiscard]] std::size_t original(std::int32_t site) const {
    return static_cast<std::size_t>(sites_.original(site));
  }
  RestrictedVoronoi::Row& row(std::int32_t site) { return result_.rows[original(site)]; }

  [[nodiscard]] bool missing_area() const {
    double covered = 0.0;
    for (const Moments& cell : result_.cells) covered += cell.area;
    return count() > 0 && surface_.area() - covered > 1e-11 * surface_.area();
  }

  /// Find the faces that the floods left uncovered, decide whose they are, and integrate the cells
  /// that this changes again.
  void share_uncovered_faces(Context* context) {
    std::vector<Coverage> pieces;
    for (const auto& chunk : pieces_) pieces.insert(pieces.end(), chunk.begin(), chunk.end());
    std::vector<OrderedFace> uncovered = uncovered_faces(surface_, pieces);
    std::vector<std::int32_t> changed;
    if (connected_) {
      for (const Coverage& piece : pieces)
        if (std::binary_search(uncovered.begin(), uncovered.end(), piece.face))
          changed.push_back(piece.site);
      shares_ = share_out(
          surface_, pieces, uncovered,
          [this](OrderedFace face, std::span<const std::int32_t> asked,
                 std::span<const std::int32_t> rivals) { return winners(face, asked, rivals); });
      uncovered = without_owner(uncovered);
    }
    add_nearest_owners(uncovered);
    index_owners();
    for (const Share& share : shares_) changed.push_back(share.site);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    integrate(changed, context);
  }

  /// Of the sites asked, those that own something of the face when only the rivals compete.
  std::vector<std::int32_t> winners(OrderedFace face, std::span<const std::int32_t> asked,
                                    std::span<const std::int32_t> rivals) {
    CellFlood& flood = floods_.local();
    std::vector<std::int32_t> result;
    for (const std::int32_t site : asked) {
      flood.reset_among(site, rivals);
      flood.clip(face);
      if (!flood.polygon().empty()) result.push_back(site);
    }
    return result;
  }

  [[nodiscard]] std::vector<OrderedFace> without_owner(std::vector<OrderedFace> faces) const {
    std::vector<bool> owned(surface_.face_count(), false);
    for (const Share& share : shares_) owned[as_index(share.face)] = true;
    std::erase_if(faces, [&](OrderedFace face) { return owned[as_index(face)]; });
    return faces;
  }

  /// Euclidean cells, and components without any site: the sites nearest in space.
  void add_nearest_owners(std::span<const OrderedFace> faces) {
    std::vector<std::vector<Share>> found(faces.size());
    parallel_chunks(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      if (context_) context_->check();
      for (std::size_t k = begin; k < end; ++k) found[k] = nearest_owners(faces[k]);
    });
    for (const auto& part : found) shares_.insert(shares_.end(), part.begin(), part.end());
    std::sort(shares_.begin(), shares_.end());
  }

  void index_owners() {
    divided_.assign(surface_.face_count() + 1, 0);
    for (const Share& share : shares_) ++divided_[as_index(share.face) + 1];
    std::partial_sum(divided_.begin(), divided_.end(), divided_.begin());
    owners_.resize(shares_.size());
    std::vector<std::size_t> next(divided_.begin(), divided_.end() - 1);
    for (const Share& share : shares_)  // sorted by site, and so is each row
      owners_[next[as_index(share.face)]++] = share.site;
  }

  /// From the site nearest to the face's centroid on, every site across an edge of a piece owns a
  /// piece too.
  std::vector<Share> nearest_owners(OrderedFace face) {
    CellFlood& flood = floods_.local();
    std::vector<std::int32_t> known = {nearest_to(face)};
    std::vector<Share> result;
    for (std::size_t k = 0; k < known.size(); ++k) {
      for (std::int32_t site = known[k]; !flood.reset(site);) site = flood.owner();
      flood.clip(face);
      const auto add = [&](std::int32_t j) {
        if (std::find(known.begin(), known.end(), j) == known.end()) known.push_back(j);
      };
      if (!flood.polygon().empty()) result.push_back({flood.owner(), face});
      if (flood.tied_to() >= 0) add(flood.tied_to());
      for (const Polygon::Corner& corner : flood.polygon().corners())
        if (corner.edge >= 0) add(flood.bisector(corner.edge).site);
    }
    return result;
  }

  [[nodiscard]] std::int32_t nearest_to(OrderedFace face) const {
    const auto near = std::lower_bound(sites_.faces.begin(), sites_.faces.end() - 1, face);
    return index_.nearest(surface_.ordered().geometry(face).centroid,
                          static_cast<std::int32_t>(near - sites_.faces.begin()));
  }

  void collect(std::int32_t site, std::vector<CellPolygon>& out) {
    CellFlood& flood = floods_.local();
    for_each_piece(
        flood, site,
        [&](OrderedFace face, bool) {
          CellPolygon piece{sites_.original(site), surface_.ordered().original_face(face), {}, {}};
          for (const Polygon::Corner& corner : flood.polygon().corners()) {
            piece.points.push_back(corner.x + flood.position());
            piece.edges.push_back(
                corner.edge < 0 ? corner.edge : sites_.original(flood.bisector(corner.edge).site));
          }
          out.push_back(std::move(piece));
        },
        [] {});
  }

  const Surface& surface_;
  OrderedSites sites_;
  SiteIndex index_;
  bool whole_;      // no cell can have parts that its site does not reach
  bool connected_;  // cells follow the surface
  Context* context_;
  tbb::enumerable_thread_specific<CellFlood> floods_;
  std::vector<std::vector<Coverage>> pieces_;  // of the last floods, per chunk
  std::vector<Share> shares_;                  // of uncovered faces; sorted by site
  std::vector<std::size_t> divided_;           // per face, one more: rows of owners_
  std::vector<std::int32_t> owners_;           // of divided faces
  RestrictedVoronoi result_;
};

}  // namespace

RestrictedVoronoi unit_voronoi(const Surface& surface, const Sites& sites, Context* context,
                               Cells cells) {
  return Builder(surface, sites, nullptr, cells, context).build();
}

RestrictedVoronoi without_unit(RestrictedVoronoi diagram, double density_unit) {
  if (density_unit == 1.0) return diagram;
  const double once = 1.0 / density_unit;  // twice at once may leave the range of numbers
  for (Moments& cell : diagram.cells) {
    cell.capacity *= once;
    cell.mass = cell.mass * once * once;
    cell.first = cell.first * once * once;
    cell.second = cell.second * once * once;
  }
  for (CellBoundary& side : diagram.boundaries) side.flux *= once;
  return diagram;
}

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites, Context* context,
                                     Cells cells) {
  check_sites(surface, sites);
  return without_unit(unit_voronoi(surface, sites, context, cells),
                      surface.ordered().density_unit());
}

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                     const SiteGraph& graph, Context* context, Cells cells) {
  return Builder(surface, sites, &graph, cells, context).build();
}

std::vector<CellPolygon> restricted_voronoi_polygons(const Surface& surface, const Sites& sites,
                                                     Cells cells, Context* context) {
  check_sites(surface, sites);
  Stretch cutting(context, 0.0, kCut), collecting(context, kCut, 1.0);
  Builder builder(surface, sites, nullptr, cells, cutting.context());
  builder.build();
  return builder.polygons(collecting.context());
}

}  // namespace dapple
