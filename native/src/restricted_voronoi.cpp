// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <dapple/neighbours.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <numeric>
#include <optional>

#include "integrate.hpp"
#include "parallel.hpp"
#include "polygon.hpp"
#include "shared_faces.hpp"
#include "site_graph.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFirstNeighbours = 12;  // enough for most cells; more are fetched on demand
constexpr std::size_t kGrain = 32;            // cells a chunk
constexpr double kTie = 1e-14;  // of a polygon's squared radius: rounding of x . (x_j - x_i)

/// The sites in the order of their faces, which is also an order in space.
struct OrderedSites {
  std::vector<std::int32_t> original;  // caller's index
  std::vector<Vec3> positions;
  std::vector<std::int32_t> faces;  // ordered faces

  OrderedSites(const Surface& surface, const Sites& sites) : original(sites.size()) {
    std::vector<std::int32_t> ordered(sites.size());
    for (std::size_t k = 0; k < sites.size(); ++k)
      ordered[k] = surface.ordered_face(sites.faces[k]);
    std::iota(original.begin(), original.end(), 0);
    std::sort(original.begin(), original.end(), [&](std::int32_t a, std::int32_t b) {
      const std::int32_t fa = ordered[static_cast<std::size_t>(a)];
      const std::int32_t fb = ordered[static_cast<std::size_t>(b)];
      return fa != fb ? fa < fb : a < b;
    });
    for (const std::int32_t k : original) {
      positions.push_back(sites.positions[static_cast<std::size_t>(k)]);
      faces.push_back(ordered[static_cast<std::size_t>(k)]);
    }
  }
};

/// Knows which sites are near: from a tree, or from a graph of the sites whose cells touch.
class SiteIndex {
 public:
  /// The arguments must outlive the index. \param graph of the caller's sites, or null
  SiteIndex(const OrderedSites& sites, const SiteGraph* graph) : sites_(&sites), graph_(graph) {
    if (!graph) {
      tree_.emplace(sites.positions);
      return;
    }
    ordered_.resize(sites.original.size());
    for (std::size_t k = 0; k < ordered_.size(); ++k)
      ordered_[static_cast<std::size_t>(sites.original[k])] = static_cast<std::int32_t>(k);
  }

  [[nodiscard]] const Neighbours* tree() const { return tree_ ? &*tree_ : nullptr; }
  [[nodiscard]] std::span<const SiteGraph::Link> links(std::int32_t site) const {
    return graph_->of(static_cast<std::size_t>(original(site)));
  }
  [[nodiscard]] std::int32_t ordered(std::int32_t original) const {
    return ordered_[static_cast<std::size_t>(original)];
  }

  /// Only the way there depends on `from`, a site that is better near.
  [[nodiscard]] std::int32_t nearest(const Vec3& point, std::int32_t from) const {
    if (!tree_) return walk(point, from);
    std::vector<Neighbour> found;
    tree_->nearest(point, 1, found);
    return found[0].index;
  }

 private:
  [[nodiscard]] std::int32_t original(std::int32_t site) const {
    return sites_->original[static_cast<std::size_t>(site)];
  }

  // In a Delaunay triangulation every site but the nearest has a neighbour that is nearer.
  [[nodiscard]] std::int32_t walk(const Vec3& point, std::int32_t site) const {
    double best = squared_distance(point, site);
    for (bool moved = true; moved;) {
      moved = false;
      for (const SiteGraph::Link& link : links(site)) {
        const std::int32_t j = ordered(link.site);
        const double squared = squared_distance(point, j);
        if (squared > best || (squared == best && link.site >= original(site))) continue;
        best = squared;
        site = j;
        moved = true;
        break;
      }
    }
    return site;
  }

  [[nodiscard]] double squared_distance(const Vec3& point, std::int32_t site) const {
    return (sites_->positions[static_cast<std::size_t>(site)] - point).squaredNorm();
  }

  const OrderedSites* sites_;
  const SiteGraph* graph_;
  std::optional<Neighbours> tree_;     // without a graph
  std::vector<std::int32_t> ordered_;  // with a graph: caller's -> ordered
};

/// The half-space of points nearer to the site than to a neighbour: x . normal <= offset, x
/// relative to the site.
struct Bisector {
  Vec3 normal;  // x_j - x_i
  double offset;
  double squared_distance;
  std::int32_t site;  // ordered index of j
};

/// The bisectors of one site in order of distance, fetched as far as someone asks.
class Bisectors {
 public:
  Bisectors(const OrderedSites& sites, const SiteIndex& index) : sites_(&sites), index_(&index) {}

  void reset(std::int32_t site) {
    site_ = site;
    fetched_ = 0;
    if (index_->tree())
      fetch(kFirstNeighbours + 1);
    else
      take_links();
  }

  /// Only with some other sites, sorted; all of them are known at once.
  void reset_among(std::int32_t site, std::span<const std::int32_t> others) {
    site_ = site;
    fetched_ = sites_->positions.size();
    bisectors_.clear();
    for (const std::int32_t other : others)
      if (other != site) add(other);
    sort();
    settled_ = bisectors_.size();
  }

  /// Bisector k, or null if there are no more sites.
  const Bisector* at(std::size_t k) {
    while (k >= settled_ && fetched_ < sites_->positions.size()) fetch(2 * fetched_);
    return k < settled_ ? bisectors_.data() + k : nullptr;
  }

 private:
  void fetch(std::size_t count) {
    index_->tree()->nearest(sites_->positions[static_cast<std::size_t>(site_)], count, found_);
    fetched_ = found_.size();
    bisectors_.clear();
    for (const Neighbour& found : found_)
      if (found.index != site_) add(found.index);
    sort();
    settle();
  }

  void sort() {
    const auto original = [&](const Bisector& b) {
      return sites_->original[static_cast<std::size_t>(b.site)];
    };
    std::sort(bisectors_.begin(), bisectors_.end(), [&](const Bisector& a, const Bisector& b) {
      return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                      : original(a) < original(b);
    });
    drop_twins();
  }

  // Of coincident sites the first of the caller's owns the cell. The others share its plane; where
  // rounding lets theirs cut once more, the boundary would bear the name of an empty cell.
  void drop_twins() {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < bisectors_.size(); ++k) {
      const Bisector& b = bisectors_[k];
      bool twin = false;
      for (std::size_t p = kept; p > 0 && bisectors_[p - 1].squared_distance == b.squared_distance;
           --p)
        twin = twin || (b.squared_distance > 0.0 && bisectors_[p - 1].normal == b.normal);
      if (!twin) bisectors_[kept++] = b;
    }
    bisectors_.resize(kept);
  }

  void add(std::int32_t other) {
    const auto position = [&](std::int32_t k) {
      return sites_->positions[static_cast<std::size_t>(k)];
    };
    const Vec3 d = position(other) - position(site_);
    bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), other});
  }

  void take_links() {
    bisectors_.clear();
    for (const auto& [site, d] : index_->links(site_))
      bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), index_->ordered(site)});
    settled_ = bisectors_.size();
    fetched_ = sites_->positions.size();
  }

  // Which of several sites at the last distance were found is an accident of the tree: they count
  // only when a longer list has found all of them.
  void settle() {
    settled_ = bisectors_.size();
    if (fetched_ == sites_->positions.size() || bisectors_.empty()) return;
    const double last = found_.back().squared_distance;
    while (settled_ > 0 && bisectors_[settled_ - 1].squared_distance >= last) --settled_;
  }

  const OrderedSites* sites_;
  const SiteIndex* index_;
  std::int32_t site_ = 0;
  std::size_t fetched_ = 0;
  std::size_t settled_ = 0;
  std::vector<Neighbour> found_;
  std::vector<Bisector> bisectors_;
};

/// Walks the pieces of one cell after another; one per thread.
class CellFlood {
 public:
  CellFlood(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
      : surface_(&surface),
        sites_(&sites),
        bisectors_(sites, index),
        stamps_(surface.face_count(), 0) {}

  /// Turn to a site. False if a coincident site of lower (caller's) index owns the cell: see
  /// owner().
  bool reset(std::int32_t site) {
    site_ = owner_ = site;
    bisectors_.reset(site);
    for (std::size_t k = 0; const Bisector* b = bisectors_.at(k); ++k) {
      if (b->squared_distance > 0.0) break;
      if (original(b->site) < original(owner_)) owner_ = b->site;
    }
    return owner_ == site_;
  }

  /// Turn to a site that competes with `others` only.
  void reset_among(std::int32_t site, std::span<const std::int32_t> others) {
    site_ = owner_ = site;
    bisectors_.reset_among(site, others);
  }

  [[nodiscard]] std::int32_t owner() const { return owner_; }
  [[nodiscard]] const Vec3& position() const {
    return sites_->positions[static_cast<std::size_t>(site_)];
  }
  [[nodiscard]] const Bisector& bisector(std::int32_t k) {
    return *bisectors_.at(static_cast<std::size_t>(k));
  }
  [[nodiscard]] const Polygon& polygon() const { return polygon_; }
  /// The site that the face clipped last went to because it lies in the bisector; -1 if it did not.
  [[nodiscard]] std::int32_t tied_to() const { return tied_to_; }

  /// Clip a face to the site's cell; true if nothing was cut off.
  ///
  /// What lies in a bisector, to rounding, is as near to one site as to the other: both give it to
  /// the lower (caller's) index.
  bool clip(std::int32_t face) {
    tied_to_ = -1;
    const auto [a, b, c] = surface_->corners(face);
    const Vec3& x = position();
    polygon_.start(surface_->vertex(a) - x, surface_->vertex(b) - x, surface_->vertex(c) - x);
    double radius = polygon_.squared_radius();
    bool whole = true;
    std::size_t k = 0;
    for (const Bisector* b_k = bisectors_.at(0); b_k && b_k->squared_distance < 4.0 * radius;
         b_k = bisectors_.at(++k)) {
      if (b_k->squared_distance == 0.0) continue;
      const auto [low, high] = polygon_.measure(b_k->normal, b_k->offset);
      if (low >= -kTie * radius && high <= kTie * radius) {
        if (original(site_) < original(b_k->site)) continue;
        tied_to_ = b_k->site;
        polygon_.clear();
        return false;
      }
      if (high <= 0.0) continue;
      polygon_.cut(static_cast<std::int32_t>(k));
      whole = false;
      radius = polygon_.squared_radius();
    }
    return whole;
  }

  /// Call `visit(face, whole)` for each piece of the cell that is connected to one of the seeds.
  template <typename Visit>
  void flood(std::span<const std::int32_t> seeds, const Visit& visit) {
    ++stamp_;
    pending_.clear();
    for (const std::int32_t face : seeds) push(face);
    while (!pending_.empty()) {
      const std::int32_t face = pending_.back();
      pending_.pop_back();
      const bool whole = clip(face);
      if (polygon_.empty()) continue;
      visit(face, whole);
      for (const Polygon::Corner& corner : polygon_.corners())
        if (corner.edge < 0) cross(3 * face - 1 - corner.edge);
    }
  }

 private:
  [[nodiscard]] std::int32_t original(std::int32_t site) const {
    return sites_->original[static_cast<std::size_t>(site)];
  }

  void push(std::int32_t face) {
    std::int32_t& stamp = stamps_[static_cast<std::size_t>(face)];
    if (stamp == stamp_) return;
    stamp = stamp_;
    pending_.push_back(face);
  }

  void cross(std::int32_t half_edge) {
    for (std::int32_t h = surface_->next_around(half_edge); h != half_edge;
         h = surface_->next_around(h))
      push(h / 3);
  }

  const Surface* surface_;
  const OrderedSites* sites_;
  Bisectors bisectors_;
  std::int32_t site_ = 0;
  std::int32_t owner_ = 0;
  std::int32_t tied_to_ = -1;
  Polygon polygon_;
  std::vector<std::int32_t> stamps_;  // per face: the last flood that reached it
  std::int32_t stamp_ = 0;
  std::vector<std::int32_t> pending_;
};

/// Integrates the pieces of one cell.
class CellIntegrals {
 public:
  CellIntegrals(const Surface& surface, CellFlood& flood) : surface_(&surface), flood_(&flood) {}

  void reset() {
    moments_ = Moments();
    boundary_.clear();
  }

  void add(std::int32_t face, bool whole) {
    const FaceGeometry& geometry = surface_->geometry(face);
    if (geometry.moments.area <= 0.0) return;
    const Vec3 centroid = geometry.centroid - flood_->position();
    if (whole) {
      add_shifted(moments_, geometry.moments, centroid);
      return;
    }
    set_density(geometry, centroid);
    add_area(geometry);
    add_boundary(geometry);
  }

  [[nodiscard]] const Moments& moments() const { return moments_; }

  /// Move on to other bisectors: merge what was found with those used so far into `out`, by site.
  void flush_boundary(const OrderedSites& sites, std::vector<CellBoundary>& out) {
    for (std::size_t k = 0; k < boundary_.size(); ++k) {
      if (boundary_[k].length <= 0.0) continue;
      const Bisector& bisector = flood_->bisector(static_cast<std::int32_t>(k));
      const std::int32_t j = sites.original[static_cast<std::size_t>(bisector.site)];
      const auto known = std::find_if(out.begin(), out.end(), [&](const CellBoundary& side) {
        return side.neighbour == j && side.offset == bisector.normal;
      });
      if (known == out.end()) {
        out.push_back({j, boundary_[k].flux, bisector.normal, boundary_[k].length});
      } else {
        known->flux += boundary_[k].flux;
        known->length += boundary_[k].length;
      }
    }
    boundary_.clear();
  }

 private:
  void set_density(const FaceGeometry& geometry, const Vec3& centroid) {
    gradient_ = geometry.density_gradient;
    at_site_ = geometry.moments.capacity / geometry.moments.area - gradient_.dot(centroid);
  }
  [[nodiscard]] double density(const Vec3& x) const { return at_site_ + gradient_.dot(x); }

  void add_area(const FaceGeometry& geometry) {
    const auto corners = flood_->polygon().corners();
    const Vec3& a = corners[0].x;
    Moments piece;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const Vec3& b = corners[k - 1].x;
      const Vec3& c = corners[k].x;
      const double area = 0.5 * geometry.normal.dot((b - a).cross(c - a));
      if (surface_->uniform())
        add_uniform_triangle(piece, area, a, b, c);
      else
        add_linear_triangle(piece, area, a, b, c, density(a), density(b), density(c));
    }
    if (surface_->uniform()) finish_uniform(piece);
    add_shifted(moments_, piece, Vec3::Zero());
  }

  // Along a bisector phi (x - x_i) has degree 2: Simpson's rule is exact.
  void add_boundary(const FaceGeometry& geometry) {
    const auto corners = flood_->polygon().corners();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (corners[k].edge < 0) continue;
      const Vec3& p = corners[k].x;
      const Vec3& q = corners[k + 1 < corners.size() ? k + 1 : 0].x;
      const Vec3& d = flood_->bisector(corners[k].edge).normal;
      const double in_plane = (d - d.dot(geometry.normal) * geometry.normal).norm();
      const double length = (q - p).norm();
      if (in_plane <= 0.0 || length <= 0.0) continue;
      const Vec3 middle = 0.5 * (p + q);
      CellBoundary& sum = boundary_with(corners[k].edge);
      sum.length += length;
      sum.flux += length / (6.0 * in_plane) *
                  (density(p) * p + 4.0 * density(middle) * middle + density(q) * q);
    }
  }

  CellBoundary& boundary_with(std::int32_t bisector) {
    const auto k = static_cast<std::size_t>(bisector);
    if (k >= boundary_.size()) boundary_.resize(k + 1, {-1, Vec3::Zero(), Vec3::Zero(), 0.0});
    return boundary_[k];
  }

  const Surface* surface_;
  CellFlood* flood_;
  Moments moments_;
  std::vector<CellBoundary> boundary_;  // per bisector
  Vec3 gradient_ = Vec3::Zero();
  double at_site_ = 1.0;
};

class Builder {
 public:
  Builder(const Surface& surface, const Sites& sites, const SiteGraph* graph, Cells cells,
          const Context* context)
      : surface_(surface),
        sites_(surface, sites),
        index_(sites_, graph),
        whole_(graph && graph->periodic),
        connected_(cells == Cells::kConnected),
        context_(context),
        floods_([this] { return CellFlood(surface_, sites_, index_); }) {}

  RestrictedVoronoi build() {
    result_.cells.resize(count());
    result_.rows.resize(count());
    std::vector<std::int32_t> all(count());
    std::iota(all.begin(), all.end(), 0);
    integrate(all);
    if (!whole_ && missing_area()) {
      give_away_orphans();
    }
    pieces_.clear();
    return std::move(result_);
  }

  std::vector<CellPolygon> polygons() {
    build();
    std::vector<std::vector<CellPolygon>> cells(count());
    parallel_chunks(count(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        collect(static_cast<std::int32_t>(s), cells[static_cast<std::size_t>(sites_.original[s])]);
    });
    std::vector<CellPolygon> result;
    for (auto& cell : cells) std::move(cell.begin(), cell.end(), std::back_inserter(result));
    return result;
  }

 private:
  [[nodiscard]] std::size_t count() const { return sites_.positions.size(); }

  /// A site's shares of orphans, as a range of shares_.
  [[nodiscard]] std::span<const Share> shares_of(std::int32_t site) const {
    const auto first = std::lower_bound(shares_.begin(), shares_.end(), Share{site, -1});
    const auto last = std::lower_bound(first, shares_.end(), Share{site + 1, -1});
    return {first, last};
  }

  /// Call `visit(face, whole)` for each piece of the site's cell, and `flush()` after each change
  /// of bisectors. Orphans with owners are divided among these; what floods found there is void.
  template <typename Visit, typename Flush>
  void for_each_piece(CellFlood& flood, std::int32_t site, const Visit& visit, const Flush& flush) {
    if (!flood.reset(site)) return;
    flood.flood(starts(site), [&](std::int32_t face, bool whole) {
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
  [[nodiscard]] std::vector<std::int32_t> starts(std::int32_t site) const {
    std::vector<std::int32_t> faces = {sites_.faces[static_cast<std::size_t>(site)]};
    if (!connected_)
      for (const Share& share : shares_of(site)) faces.push_back(share.face);
    return faces;
  }

  [[nodiscard]] bool is_divided(std::int32_t face) const {
    return connected_ && !divided_.empty() && !owners_of(face).empty();
  }
  [[nodiscard]] std::span<const std::int32_t> owners_of(std::int32_t face) const {
    const auto f = static_cast<std::size_t>(face);
    return std::span(owners_).subspan(divided_[f], divided_[f + 1] - divided_[f]);
  }

  void integrate(std::span<const std::int32_t> sites) {
    const std::size_t chunks = (sites.size() + kGrain - 1) / kGrain;
    std::vector<std::vector<CellBoundary>> boundaries(chunks);
    pieces_.assign(chunks, {});
    parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      if (context_) context_->check();
      integrate_chunk(sites.subspan(begin, end - begin), boundaries[begin / kGrain],
                      pieces_[begin / kGrain]);
    });
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
          [&](std::int32_t face, bool whole) {
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
    return static_cast<std::size_t>(sites_.original[static_cast<std::size_t>(site)]);
  }
  RestrictedVoronoi::Row& row(std::int32_t site) { return result_.rows[original(site)]; }

  [[nodiscard]] bool missing_area() const {
    double covered = 0.0;
    for (const Moments& cell : result_.cells) covered += cell.area;
    return count() > 0 && surface_.area() - covered > 1e-11 * surface_.area();
  }

  /// Find the faces that the floods left uncovered, decide whose they are, and integrate the cells
  /// that this changes again.
  void give_away_orphans() {
    std::vector<Coverage> pieces;
    for (const auto& chunk : pieces_) pieces.insert(pieces.end(), chunk.begin(), chunk.end());
    std::vector<std::int32_t> orphans = find_orphans(surface_, pieces);
    std::vector<std::int32_t> changed;
    if (connected_) {
      for (const Coverage& piece : pieces)
        if (std::binary_search(orphans.begin(), orphans.end(), piece.face))
          changed.push_back(piece.site);
      shares_ = share_orphans(surface_, pieces, orphans,
                              [this](std::int32_t face, const std::vector<std::int32_t>& sites) {
                                return winners(face, sites);
                              });
      orphans = without_owner(orphans);
    }
    add_nearest_owners(orphans);
    index_owners();
    for (const Share& share : shares_) changed.push_back(share.site);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    integrate(changed);
  }

  /// Of the candidates, those that own something of the face when only they compete.
  std::vector<std::int32_t> winners(std::int32_t face,
                                    const std::vector<std::int32_t>& candidates) {
    CellFlood& flood = floods_.local();
    std::vector<std::int32_t> result;
    for (const std::int32_t site : candidates) {
      flood.reset_among(site, candidates);
      flood.clip(face);
      if (!flood.polygon().empty()) result.push_back(site);
    }
    return result;
  }

  [[nodiscard]] std::vector<std::int32_t> without_owner(std::vector<std::int32_t> faces) const {
    std::vector<bool> owned(surface_.face_count(), false);
    for (const Share& share : shares_) owned[static_cast<std::size_t>(share.face)] = true;
    std::erase_if(faces, [&](std::int32_t face) { return owned[static_cast<std::size_t>(face)]; });
    return faces;
  }

  /// Euclidean cells, and components without any site: the sites nearest in space.
  void add_nearest_owners(std::span<const std::int32_t> faces) {
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
    for (const Share& share : shares_) ++divided_[static_cast<std::size_t>(share.face) + 1];
    std::partial_sum(divided_.begin(), divided_.end(), divided_.begin());
    owners_.resize(shares_.size());
    std::vector<std::size_t> next(divided_.begin(), divided_.end() - 1);
    for (const Share& share : shares_)  // sorted by site, and so is each row
      owners_[next[static_cast<std::size_t>(share.face)]++] = share.site;
  }

  /// From the site nearest to the face's centroid on, every site across an edge of a piece owns a
  /// piece too.
  std::vector<Share> nearest_owners(std::int32_t face) {
    CellFlood& flood = floods_.local();
    std::vector<std::int32_t> known = {nearest_to(face)};
    std::vector<Share> result;
    for (std::size_t k = 0; k < known.size(); ++k) {
      if (!flood.reset(known[k]) && !flood.reset(flood.owner())) continue;
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

  [[nodiscard]] std::int32_t nearest_to(std::int32_t face) const {
    const auto near = std::lower_bound(sites_.faces.begin(), sites_.faces.end() - 1, face);
    return index_.nearest(surface_.geometry(face).centroid,
                          static_cast<std::int32_t>(near - sites_.faces.begin()));
  }

  void collect(std::int32_t site, std::vector<CellPolygon>& out) {
    CellFlood& flood = floods_.local();
    for_each_piece(
        flood, site,
        [&](std::int32_t face, bool) {
          CellPolygon piece{
              static_cast<std::int32_t>(original(site)), surface_.original_face(face), {}, {}};
          for (const Polygon::Corner& corner : flood.polygon().corners()) {
            piece.points.push_back(corner.x + flood.position());
            piece.edges.push_back(corner.edge < 0 ? corner.edge
                                                  : static_cast<std::int32_t>(original(
                                                        flood.bisector(corner.edge).site)));
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
  const Context* context_;
  tbb::enumerable_thread_specific<CellFlood> floods_;
  std::vector<std::vector<Coverage>> pieces_;  // of the last floods, per chunk
  std::vector<Share> shares_;                  // of orphans; sorted by site
  std::vector<std::size_t> divided_;           // per face, one more: rows of owners_
  std::vector<std::int32_t> owners_;           // of divided faces
  RestrictedVoronoi result_;
};

}  // namespace

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                     const Context* context, Cells cells) {
  return Builder(surface, sites, nullptr, cells, context).build();
}

RestrictedVoronoi restricted_voronoi(const Surface& surface, const Sites& sites,
                                     const SiteGraph& graph, const Context* context, Cells cells) {
  return Builder(surface, sites, &graph, cells, context).build();
}

std::vector<CellPolygon> restricted_voronoi_polygons(const Surface& surface, const Sites& sites,
                                                     Cells cells) {
  return Builder(surface, sites, nullptr, cells, nullptr).polygons();
}

}  // namespace dapple
