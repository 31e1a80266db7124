// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_builder.hpp"

#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 32;   // cells per chunk
constexpr std::size_t kWorks = 128;  // chunks in progress, so few that results stay in the cache
constexpr std::size_t kSum = 4096;   // cells per partial sum
constexpr double kRoom =
    1.02;  // memory for boundaries, relative to the estimate from previous cells

constexpr std::size_t kMarch = 4;  // faces per site from which a march takes less time than floods

// Share of the progress when all cells without uncovered faces are known.
constexpr double kFlooded = 0.7;

std::size_t chunks_of(std::size_t count) { return (count + kGrain - 1) / kGrain; }

/// Reserve memory for `needed` values, estimating the total from the values since `first`. Memory
/// of an earlier run need not be cleared.
template <typename T>
void make_room(std::vector<T>& values, std::size_t first, std::size_t needed, double share) {
  if (needed <= values.size()) return;
  const double more = kRoom * static_cast<double>(needed - first) / share;
  values.reserve(first + static_cast<std::size_t>(more));
  values.resize(needed);
}

/// A cell without area or density may have rounding errors of either sign.
Moments not_negative(Moments cell) {
  for (double* value : {&cell.area, &cell.capacity, &cell.mass, &cell.second})
    *value = std::max(*value, 0.0);
  return cell;
}

}  // namespace

CellBuilder::CellBuilder(const Surface& surface)
    : surface_(surface), index_(sites_), workers_([this] { return Worker(*this); }) {}

/// Find the faces that the cells of so many sites extend over, if those are not all.
void CellBuilder::find_support(std::size_t count) {
  if (!has_gaps_) has_gaps_ = has_gaps(surface_);
  if (!*has_gaps_ || (support_ && support_count_ == count)) return;
  support_count_ = count;
  support_ =
      std::make_shared<const DensitySupport>(surface_, *face_edges_of(surface_.ordered()), count);
}

void CellBuilder::build(const Sites& sites, const SiteGraph* graph, Cells cells, bool leaves_gaps,
                        Context* context, RestrictedVoronoi& result) {
  begin(sites.size(), cells, leaves_gaps, context, result);
  if (graph || !is_for_march(sites))
    flood(sites, graph);
  else
    march(sites, context);
  if (context) context->advance(1.0);
}

void CellBuilder::build_by_floods(const Sites& sites, const SiteGraph* graph, Cells cells,
                                  bool leaves_gaps, Context* context, RestrictedVoronoi& result) {
  begin(sites.size(), cells, leaves_gaps, context, result);
  flood(sites, graph);
  if (context) context->advance(1.0);
}

void CellBuilder::begin(std::size_t count, Cells cells, bool leaves_gaps, Context* context,
                        RestrictedVoronoi& result) {
  result_ = &result;
  connected_ = cells == Cells::kConnected;
  leaves_ = connected_ && leaves_gaps;
  if (leaves_) find_support(count);
  context_ = context;
  shares_.clear();
  divided_.clear();
}

/// Compute each cell on its own.
void CellBuilder::flood(const Sites& sites, const SiteGraph* graph) {
  whole_ = graph && graph->periodic;
  start(sites, graph);
  find_area_to_cover();
  Stretch flooding(context_, 0.0, whole_ ? 1.0 : kFlooded), mending(context_, kFlooded, 1.0);
  integrate(all_, flooding.context());
  if (!whole_ && missing_area()) share_uncovered_faces(mending.context());
  result_->boundaries.resize(boundary_count_);
}

/// Whether there are so many faces that it takes less time to go through them than to flood each
/// cell.
bool CellBuilder::is_for_march(const Sites& sites) const {
  const std::size_t count = sites.size();
  const std::size_t faces = support() ? support()->face_count() : surface_.face_count();
  if (count == 0 || faces < kMarch * count) return false;
  if (!support()) return true;
  const OrderedSurface& mesh = surface_.ordered();
  return std::all_of(sites.faces.begin(), sites.faces.end(),
                     [&](std::int32_t face) { return support()->has(mesh.counted_face(face)); });
}

void CellBuilder::march(const Sites& sites, Context* context) {
  if (!march_) march_ = std::make_unique<FaceMarch>(surface_, sites_, index_);
  place_sites(sites);
  if (!leaves_) share_out_alone();
  march_->start(support(), {divided_, owners_}, context);
  share_out_on(connected_ ? march_->disconnected_faces() : std::span<const OrderedFace>(), context);
  if (connected_)
    if (const std::vector<OrderedFace> faces = march_->islands(); !faces.empty())
      share_out_on(faces, context);
  march_->collect(*result_);
}

/// Sort the sites and make lists of those near each, unless the last ones hold.
void CellBuilder::place_sites(const Sites& sites) {
  const StageSpan finding(context_, Stage::kNeighbors);
  NearLists& lists = march_->lists();
  if (lists.hold_for(sites, connected_)) {
    sites_.move(surface_, sites);
    index_.refit();
    lists.move();
    return;
  }
  lists.forget();  // they do not hold for another order, even if this is interrupted
  sites_.assign(surface_, sites);
  index_.update();
  lists.make(connected_);
}

/// The faces of components without a site.
std::vector<OrderedFace> CellBuilder::faces_without_sites() const {
  std::vector<OrderedFace> faces;
  const OrderedSurface& mesh = surface_.ordered();
  if (!connected_ || mesh.components() < 2) return faces;
  for (std::size_t f = 0; f < surface_.face_count(); ++f)
    if (mesh.counts(nth_face(f)) && march_->lists().site_on(mesh.component(nth_face(f))) < 0)
      faces.push_back(nth_face(f));
  return faces;
}

/// Give the faces of components without a site to the nearest sites in space.
void CellBuilder::share_out_alone() {
  const std::vector<OrderedFace> alone = faces_without_sites();
  if (alone.empty()) return;
  for (Worker& worker : workers_) worker.flood.restart();
  add_nearest_owners(alone);
  index_owners();
}

/// Divide faces, with pieces that are not connected to their site, among sites that they are
/// connected to.
void CellBuilder::share_out_on(std::span<const OrderedFace> faces, Context* context) {
  if (faces.empty()) return march_->divide(faces, {divided_, owners_}, context);
  for (Worker& worker : workers_) worker.flood.restart();
  const std::vector<Share> shares = share_out(
      surface_, march_->pieces_around(faces), faces,
      [this](OrderedFace face, std::span<const std::int32_t> asked,
             std::span<const std::int32_t> rivals) { return winners(face, asked, rivals); });
  shares_.insert(shares_.end(), shares.begin(), shares.end());
  std::sort(shares_.begin(), shares_.end());
  index_owners();
  march_->divide(faces, {divided_, owners_}, context);
}

/// The area of the surface without components that belong to no site.
void CellBuilder::find_area_to_cover() {
  area_to_cover_ = surface_.area();
  const OrderedSurface& mesh = surface_.ordered();
  if (!leaves_ || mesh.components() < 2) return;
  if (component_areas_.empty()) {
    component_areas_.resize(static_cast<std::size_t>(mesh.components()), 0.0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      component_areas_[static_cast<std::size_t>(mesh.component(nth_face(f)))] +=
          mesh.geometry(nth_face(f)).moments.area;
  }
  std::vector<bool> has_site(component_areas_.size(), false);
  for (const OrderedFace face : sites_.faces)
    has_site[static_cast<std::size_t>(mesh.component(face))] = true;
  if (std::find(has_site.begin(), has_site.end(), false) == has_site.end()) return;
  area_to_cover_ = 0.0;
  for (std::size_t c = 0; c < has_site.size(); ++c)
    if (has_site[c]) area_to_cover_ += component_areas_[c];
}

void CellBuilder::start(const Sites& sites, const SiteGraph* graph) {
  const StageSpan finding(context_, Stage::kNeighbors);
  if (march_) march_->lists().forget();  // they refer to the last order of sites
  sites_.assign(surface_, sites);
  links_.assign(sites_, graph);
  if (!graph) index_.update();
  for (Worker& worker : workers_) worker.flood.restart(support());
  const std::span<const std::int32_t> order =
      graph ? std::span<const std::int32_t>() : index_.by_neighborhood();
  all_.resize(count());
  std::iota(all_.begin(), all_.end(), 0);
  std::copy(order.begin(), order.end(), all_.begin());
  boundary_count_ = 0;
  result_->cells.resize(count());
  result_->rows.resize(count());
}

std::vector<CellPolygon> CellBuilder::polygons(Context* context) {
  std::vector<std::vector<CellPolygon>> cells(count());
  Tally tally(context, count());
  parallel_chunks(count(), kGrain, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t s = begin; s < end; ++s)
      collect(static_cast<std::int32_t>(s), cells[original(static_cast<std::int32_t>(s))]);
    tally.add(end - begin);
  });
  std::size_t pieces = 0;
  for (const auto& cell : cells) pieces += cell.size();
  std::vector<CellPolygon> result;
  result.reserve(pieces);
  for (auto& cell : cells) std::move(cell.begin(), cell.end(), std::back_inserter(result));
  return result;
}

/// The uncovered faces of which a site owns a part, as a range of shares_.
std::span<const Share> CellBuilder::shares_of(std::int32_t site) const {
  const auto first = std::lower_bound(shares_.begin(), shares_.end(), Share{site, OrderedFace{-1}});
  const auto last = std::lower_bound(first, shares_.end(), Share{site + 1, OrderedFace{-1}});
  return {first, last};
}

/// Call `visit(face, whole)` for each piece of the site's cell, and `flush()` after each change of
/// bisectors. Uncovered faces with owners are divided among the owners; the floods' results on them
/// are ignored.
template <typename Visit, typename Flush>
void CellBuilder::for_each_piece(Worker& worker, std::int32_t site, const Visit& visit,
                                 const Flush& flush) {
  CellFlood& flood = worker.flood;
  if (!flood.reset(site, connected_ ? Rivals::kInSight : Rivals::kAll)) return;
  flood.flood(seeds_of(worker, site), [&](OrderedFace face, bool whole) {
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

/// The faces from which a Euclidean cell is flooded; a connected cell is flooded only from its
/// site.
std::span<const OrderedFace> CellBuilder::seeds_of(Worker& worker, std::int32_t site) const {
  worker.seeds = {sites_.faces[static_cast<std::size_t>(site)]};
  if (!connected_)
    for (const Share& share : shares_of(site)) worker.seeds.push_back(share.face);
  return worker.seeds;
}

bool CellBuilder::is_divided(OrderedFace face) const {
  return connected_ && !divided_.empty() && !owners_of(face).empty();
}

std::span<const std::int32_t> CellBuilder::owners_of(OrderedFace face) const {
  const auto f = as_index(face);
  return std::span(owners_).subspan(divided_[f], divided_[f + 1] - divided_[f]);
}

// A chunk's cells store their results in a slot that a later chunk reuses. Before reusing it, the
// results are moved to the output, where their offset is known by then.
void CellBuilder::integrate(std::span<const std::int32_t> sites, Context* context) {
  const std::size_t chunks = chunks_of(sites.size());
  chunks_.resize(std::max(chunks_.size(), std::min(chunks, kWorks)));
  for (Chunk& chunk : chunks_) chunk.clear();  // a cancelled run may have left results
  const std::size_t known = boundary_count_;
  piece_count_ = 0;
  Tally tally(context, sites.size());
  SharedLoop loop(context_, Stage::kNeighbors);
  for (std::size_t first = 0; first < chunks; first += kWorks) {
    const std::size_t works = std::min(kWorks, chunks - first);
    parallel_chunks(works, 1, [&](std::size_t k, std::size_t) {
      tally.check();
      put_away(chunks_[k]);
      const std::size_t begin = (first + k) * kGrain;
      chunks_[k].sites = sites.subspan(begin, std::min(kGrain, sites.size() - begin));
      Worker& worker = workers_.local();
      loop.run(first + k, worker.flood.laps(), [&] { integrate(chunks_[k], worker); });
      tally.add(chunks_[k].sites.size());
    });
    place(std::span(chunks_).first(works));
    const double done =
        std::min(1.0, static_cast<double>(first + works) / static_cast<double>(chunks));
    make_room(result_->boundaries, known, boundary_count_, done);
    make_room(pieces_, 0, piece_count_, done);
  }
  parallel_chunks(std::min(chunks, kWorks), 1,
                  [&](std::size_t k, std::size_t) { put_away(chunks_[k]); });
}

/// Compute the offsets of the chunks' results in the output.
void CellBuilder::place(std::span<Chunk> chunks) {
  for (Chunk& chunk : chunks) {
    chunk.first_boundary = boundary_count_;
    chunk.first_piece = piece_count_;
    boundary_count_ += chunk.boundaries.size();
    piece_count_ += chunk.pieces.size();
  }
}

void CellBuilder::put_away(Chunk& chunk) {
  for (const std::int32_t site : chunk.sites) row(site).first += chunk.first_boundary;
  std::copy(chunk.boundaries.begin(), chunk.boundaries.end(),
            result_->boundaries.begin() + static_cast<std::ptrdiff_t>(chunk.first_boundary));
  std::copy(chunk.pieces.begin(), chunk.pieces.end(),
            pieces_.begin() + static_cast<std::ptrdiff_t>(chunk.first_piece));
  chunk.clear();
}

void CellBuilder::integrate(Chunk& chunk, Worker& worker) {
  CellIntegrals& integrals = worker.integrals;
  std::vector<CellBoundary>& boundary = worker.boundary;
  for (const std::int32_t s : chunk.sites) {
    integrals.reset();
    boundary.clear();
    for_each_piece(
        worker, s,
        [&](OrderedFace face, bool whole) {
          const double before = integrals.moments().area;
          integrals.add(face, whole);
          chunk.pieces.push_back({s, face, integrals.moments().area - before});
        },
        [&] { integrals.flush_boundary(sites_, boundary); });
    row(s) = {chunk.boundaries.size(), boundary.size()};
    chunk.boundaries.insert(chunk.boundaries.end(), boundary.begin(), boundary.end());
    result_->cells[original(s)] = not_negative(integrals.moments());
  }
}

bool CellBuilder::missing_area() const {
  if (support()) return count() > 0;  // the area is no criterion with gaps
  const double covered =
      parallel_sum(count(), kSum, [&](std::size_t k) { return result_->cells[k].area; });
  return count() > 0 && area_to_cover_ - covered > 1e-11 * surface_.area();
}

bool CellBuilder::owns_nothing() const {
  return std::none_of(result_->cells.begin(), result_->cells.end(),
                      [](const Moments& cell) { return cell.capacity > 0.0; });
}

/// Find the faces that the floods left uncovered, determine their owners, and integrate the
/// affected cells again.
void CellBuilder::share_uncovered_faces(Context* context) {
  const std::span<const Coverage> pieces = std::span(pieces_).first(piece_count_);
  std::vector<OrderedFace> uncovered = uncovered_faces(surface_, pieces);
  if (support())
    std::erase_if(uncovered, [this](OrderedFace face) { return !has_density(surface_, face); });
  if (uncovered.empty()) return;
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
  if (!leaves_ || owns_nothing()) add_nearest_owners(uncovered);
  index_owners();
  for (const Share& share : shares_) changed.push_back(share.site);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  integrate(changed, context);
}

/// The sites that own a part of the face if only the rivals are considered.
std::vector<std::int32_t> CellBuilder::winners(OrderedFace face,
                                               std::span<const std::int32_t> asked,
                                               std::span<const std::int32_t> rivals) {
  CellFlood& flood = workers_.local().flood;
  std::vector<std::int32_t> result;
  for (const std::int32_t site : asked) {
    flood.reset_among(site, rivals);
    flood.clip(face);
    if (!flood.polygon().empty()) result.push_back(site);
  }
  return result;
}

std::vector<OrderedFace> CellBuilder::without_owner(std::vector<OrderedFace> faces) const {
  std::vector<bool> owned(surface_.face_count(), false);
  for (const Share& share : shares_) owned[as_index(share.face)] = true;
  std::erase_if(faces, [&](OrderedFace face) { return owned[as_index(face)]; });
  return faces;
}

/// For Euclidean cells and for parts without any site, the owners are the sites nearest in space.
void CellBuilder::add_nearest_owners(std::span<const OrderedFace> faces) {
  std::vector<std::vector<Share>> found(faces.size());
  parallel_chunks(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (context_) context_->check();
    for (std::size_t k = begin; k < end; ++k) found[k] = nearest_owners(faces[k]);
  });
  for (const auto& part : found) shares_.insert(shares_.end(), part.begin(), part.end());
  std::sort(shares_.begin(), shares_.end());
  // Each of several coincident sites may have led to the one that owns their cell.
  shares_.erase(std::unique(shares_.begin(), shares_.end()), shares_.end());
}

void CellBuilder::index_owners() {
  divided_.assign(surface_.face_count() + 1, 0);
  for (const Share& share : shares_) ++divided_[as_index(share.face) + 1];
  std::partial_sum(divided_.begin(), divided_.end(), divided_.begin());
  owners_.resize(shares_.size());
  std::vector<std::size_t> next(divided_.begin(), divided_.end() - 1);
  for (const Share& share : shares_)  // sorted by site, so each row is sorted too
    owners_[next[as_index(share.face)]++] = share.site;
}

/// If the face is far from the site, most sites near the site are irrelevant.
bool CellBuilder::reset_far(CellFlood& flood, std::int32_t site) const {
  return links_.known() ? flood.reset(site) : flood.reset_far(site);
}

/// The search starts with the site nearest to the face's centroid; each site across an edge of a
/// piece owns a piece too.
std::vector<Share> CellBuilder::nearest_owners(OrderedFace face) {
  CellFlood& flood = workers_.local().flood;
  std::vector<std::int32_t> known = {nearest_to(face)};
  std::vector<Share> result;
  for (std::size_t k = 0; k < known.size(); ++k) {
    for (std::int32_t site = known[k]; !reset_far(flood, site);) site = flood.owner();
    flood.clip(face);
    const auto add = [&](std::int32_t j) {
      if (std::find(known.begin(), known.end(), j) == known.end()) known.push_back(j);
    };
    if (flood.polygon().empty()) {
      // If two sites almost coincide, an edge may name the one without any part of the face; the
      // other one has cut it off.
      for (const std::int32_t cut : flood.cuts()) add(flood.bisector(cut).site);
      continue;
    }
    result.push_back({flood.owner(), face});
    for (const Polygon::Corner& corner : flood.polygon().corners())
      if (corner.edge >= 0) add(flood.bisector(corner.edge).site);
  }
  return result;
}

std::int32_t CellBuilder::nearest_to(OrderedFace face) const {
  const auto near = std::lower_bound(sites_.faces.begin(), sites_.faces.end() - 1, face);
  const auto from = static_cast<std::int32_t>(near - sites_.faces.begin());
  const Vec3& centroid = surface_.ordered().geometry(face).centroid;
  return links_.known() ? links_.nearest(centroid, from) : index_.nearest(centroid, from);
}

void CellBuilder::collect(std::int32_t site, std::vector<CellPolygon>& out) {
  Worker& worker = workers_.local();
  CellFlood& flood = worker.flood;
  for_each_piece(
      worker, site,
      [&](OrderedFace face, bool) {
        CellPolygon piece{sites_.original(site), surface_.ordered().original_face(face), {}, {}};
        const auto& corners = flood.polygon().corners();
        piece.points.reserve(corners.size());
        piece.edges.reserve(corners.size());
        for (const Polygon::Corner& corner : corners) {
          piece.points.push_back(corner.x + flood.position());
          piece.edges.push_back(
              corner.edge < 0 ? corner.edge : sites_.original(flood.bisector(corner.edge).site));
        }
        out.push_back(std::move(piece));
      },
      [] {});
}

}  // namespace dapple
