// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/face_march.hpp"

#include <cmath>
#include <numeric>

#include "base/parallel.hpp"
#include "base/progress.hpp"

namespace dapple {
namespace {

constexpr std::size_t kSiteGrain = 512;   // sites per chunk
constexpr std::size_t kFollowGrain = 16;  // cells that one thread follows
constexpr std::size_t kMany = 4;          // one of so many chunks is integrated twice
constexpr double kCutShare = 0.3;         // of the progress, when edges are cut

/// Set all to 0.
template <typename T>
void reset(std::vector<std::atomic<T>>& values, std::size_t size) {
  if (values.size() != size) values = std::vector<std::atomic<T>>(size);
  for (std::atomic<T>& value : values) value.store(0, std::memory_order_relaxed);
}

}  // namespace

FaceMarch::FaceMarch(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface),
      sites_(&sites),
      lists_(surface, sites, index),
      edges_(face_edges_of(surface.ordered())),
      labels_(edges_->vertex_count()),
      mesh_{surface, sites, lists_, *edges_, surface.ordered().vertices(), labels_, {},
            {},      {},    {},     0.0},
      faces_(edges_->chunks()),
      parts_(edges_->chunks()),
      cutters_([this] { return EdgeCutter(mesh_.vertices, lists_); }),
      workers_([this] { return ChunkCells(mesh_); }) {
  gather_faces();
}

/// Copy what most faces need: a fraction of their geometry.
void FaceMarch::gather_faces() {
  const OrderedSurface& mesh = surface_->ordered();
  normals_.resize(surface_->face_count());
  moments_.resize(surface_->face_count());
  parallel_chunks(surface_->face_count(), FaceEdges::kFaces,
                  [&](std::size_t begin, std::size_t end) {
                    for (std::size_t f = begin; f < end; ++f) {
                      const FaceGeometry& face = mesh.geometry(nth_face(f));
                      normals_[f] = face.normal;
                      moments_[f] = {face.moments.area, face.moments.second, Triple(face.centroid)};
                    }
                  });
  gather_flat_densities();
  mesh_.moments = moments_;
  mesh_.normals = normals_;
  if (edges_->copied().empty()) return;
  vertices_ = mesh.vertices();
  for (const std::int32_t v : edges_->copied()) vertices_.push_back(mesh.vertex(v));
  mesh_.vertices = vertices_;
}

void FaceMarch::gather_flat_densities() {
  const OrderedSurface& mesh = surface_->ordered();
  if (surface_->uniform()) return;
  flat_.resize(surface_->face_count());
  parallel_chunks(flat_.size(), FaceEdges::kFaces, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Vec3 values = mesh.densities(nth_face(f));
      const bool flat = values[0] == values[1] && values[1] == values[2];
      flat_[f] = flat ? mesh.density_unit() * values[0] : -1.0;
    }
  });
  mesh_.flat = flat_;
}

void FaceMarch::start(const DensitySupport* support, DividedFaces divided, Context* context) {
  support_ = support;
  find_sites_of_parts();
  mesh_.divided = divided;
  stale_.assign(faces_.size(), waits_ ? 1 : 0);
  mesh_.squared_spacing = std::pow(surface_->spacing(sites_->size()), 2);
  reset(descends_, labels_.size() + 1);
  parallel_chunks(labels_.size(), FaceEdges::kVertices, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    label(begin, end);
  });
  Stretch cutting(context, 0.0, kCutShare);
  Tally tally(cutting.context(), faces_.size());
  parallel_chunks(faces_.size(), 1, [&](std::size_t chunk, std::size_t) {
    tally.check();
    cutters_.local().find(edges_->edges(chunk),
                          support_ ? support_->edges(*edges_, chunk) : std::span<const char>(),
                          labels_, mesh_.squared_spacing, descends_, faces_[chunk].cuts);
    sort_faces(chunk);
    if (waits_) {
      find_doubts(faces_[chunk], faces_[chunk].cut);
    } else {
      ChunkCells& worker = workers_.local();
      worker.integrate(faces_[chunk], parts_[chunk]);
      find_doubts(faces_[chunk], worker.rest());
    }
    tally.add(1);
  });
}

void FaceMarch::find_sites_of_parts() {
  if (!support_) return;
  site_on_part_.assign(support_->part_count(), -1);
  for (std::size_t k = 0; k < sites_->size(); ++k) {
    const std::int32_t corner = edges_->corners()[as_index(sites_->faces[k])][0];
    site_on_part_[as_index(support_->part(corner))] = static_cast<std::int32_t>(k);
  }
}

/// A site that competes for a vertex; -1 if there is none.
std::int32_t FaceMarch::site_around(std::int32_t vertex) const {
  const std::int32_t face = edges_->face_at(vertex);
  if (face < 0) return -1;
  if (!support_) return lists_.site_on(surface_->ordered().component(OrderedFace{face}));
  const std::int32_t part = support_->part(vertex);
  return part < 0 ? -1 : site_on_part_[as_index(part)];
}

/// Each search begins with the label of a vertex beside it, or with the vertex's last one.
void FaceMarch::label(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) {
    const auto vertex = static_cast<std::int32_t>(v);
    const std::int32_t some = site_around(vertex);
    VertexLabel& label = labels_[v];
    if (some < 0) {
      label = {};
      continue;
    }
    const Triple x(mesh_.vertices[v]);
    std::int32_t from = lists_.were_moved() ? label.site : -1;
    if (const std::int32_t before = edges_->before(vertex); before != vertex && from < 0)
      from = labels_[as_index(before)].site;
    const bool known = from >= 0 && lists_.compete(from, some);
    const NearLists::Nearest nearest =
        known ? lists_.nearest(x, from) : lists_.search(x, first_guess(vertex, some));
    label = {nearest.site, static_cast<float>(nearest.squared_distance)};
  }
}

/// A site that competes with another one for a vertex, and may be near it.
std::int32_t FaceMarch::first_guess(std::int32_t vertex, std::int32_t some) const {
  const std::vector<OrderedFace>& faces = sites_->faces;
  const auto near =
      std::lower_bound(faces.begin(), faces.end() - 1, OrderedFace{edges_->face_at(vertex)});
  const auto site = static_cast<std::int32_t>(near - faces.begin());
  return lists_.compete(site, some) ? site : some;
}

/// Set apart the faces that lie in one cell.
void FaceMarch::sort_faces(std::size_t chunk) {
  const OrderedSurface& mesh = surface_->ordered();
  const std::size_t begin = chunk * FaceEdges::kFaces;
  const std::size_t end = std::min(begin + FaceEdges::kFaces, surface_->face_count());
  const bool all_count = mesh.connectivity().doubled.empty();
  std::vector<OrderedFace>&whole = faces_[chunk].whole, &cut = faces_[chunk].cut;
  whole.resize(end - begin);
  cut.resize(end - begin);
  std::size_t wholes = 0, cuts = 0;
  for (std::size_t f = begin; f < end; ++f) {
    if ((!all_count && !mesh.counts(nth_face(f))) || !has(nth_face(f))) continue;
    const Face& corners = edges_->corners()[f];
    const std::int32_t site = labels_[as_index(corners[0])].site;
    const bool one =
        site == labels_[as_index(corners[1])].site && site == labels_[as_index(corners[2])].site;
    whole[wholes] = nth_face(f);
    wholes += one ? 1 : 0;
    cut[cuts] = nth_face(f);
    cuts += one ? 0 : 1;
  }
  whole.resize(wholes);
  cut.resize(cuts);
}

/// Sites with a piece at an edge that has no vertex of their cell, neither in this face nor in the
/// one beyond the edge.
void FaceMarch::find_doubts(ChunkFaces& faces, std::span<const OrderedFace> among) const {
  faces.doubts.clear();
  for (const OrderedFace face : among) {
    const FaceEdges::OfFace& edges = edges_->of(face);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::span<const EdgeCuts::Link> cuts = faces.cuts.of(edges.edges[k]);
      const std::int32_t opposite = edges_->corners()[as_index(face)][(k + 2) % 3];
      for (std::size_t c = 0; c + 1 < cuts.size(); ++c)
        if (cuts[c].beyond != labels_[as_index(opposite)].site &&
            !has_vertex_beyond(face, k, cuts[c].beyond))
          faces.doubts.push_back(cuts[c].beyond);
    }
  }
}

bool FaceMarch::has_vertex_beyond(OrderedFace face, std::size_t edge, std::int32_t site) const {
  const OrderedSurface& mesh = surface_->ordered();
  const std::int32_t h = half_edge(face, static_cast<std::int32_t>(edge)), g = mesh.next_around(h);
  if (g == h || mesh.next_around(g) != h || !has(face_of(g))) return false;
  return labels_[as_index(edges_->corners()[as_index(face_of(g))][as_index((g % 3 + 2) % 3)])]
             .site == site;
}

void FaceMarch::divide(std::span<const OrderedFace> faces, DividedFaces divided, Context* context) {
  mesh_.divided = divided;
  stale_.resize(faces_.size(), 0);  // those that are not integrated yet
  for (const OrderedFace face : faces) stale_[as_index(face) / FaceEdges::kFaces] = 1;
  Stretch integrating(context, kCutShare, 1.0);
  Tally tally(integrating.context(), faces_.size());
  parallel_chunks(faces_.size(), 1, [&](std::size_t chunk, std::size_t) {
    tally.check();
    if (stale_[chunk] != 0) workers_.local().integrate(faces_[chunk], parts_[chunk]);
    tally.add(1);
  });
  std::fill(stale_.begin(), stale_.end(), 0);
}

std::vector<OrderedFace> FaceMarch::islands() const {
  std::vector<OrderedFace> faces;
  for (const ChunkParts& chunk : parts_)
    faces.insert(faces.end(), chunk.islands.begin(), chunk.islands.end());
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

/// An edge whose ends have one label lies in that cell. Along such edges each vertex that descends
/// leads to one that is nearer to the site, until none does. A cell is connected if all of its
/// vertices lead to a vertex of the face that holds the site, and all pieces without a vertex lie
/// beside one with a vertex. Of other cells that is not known.
void FaceMarch::find_doubtful_sites() {
  reset(doubtful_, sites_->size());
  for (const ChunkFaces& chunk : faces_)
    for (const std::int32_t site : chunk.doubts) doubtful_[as_index(site)] = 1;
  const auto doubt_around = [this](std::int32_t v) {
    if (labels_[as_index(v)].site >= 0) doubtful_[as_index(labels_[as_index(v)].site)] = 1;
  };
  std::for_each(edges_->pinched().begin(), edges_->pinched().end(), doubt_around);
  if (support_) std::for_each(support_->pinched().begin(), support_->pinched().end(), doubt_around);
  find_roots();
  doubts_.clear();
  for (std::size_t k = 0; k < doubtful_.size(); ++k)
    if (doubtful_[k] != 0) doubts_.push_back(static_cast<std::int32_t>(k));
}

void FaceMarch::find_roots() {
  parallel_chunks(labels_.size(), FaceEdges::kVertices, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::int32_t site = labels_[v].site;
      if (descends_[v] != 0 || site < 0 || edges_->face_at(static_cast<std::int32_t>(v)) < 0)
        continue;
      const Face& home = edges_->corners()[as_index(sites_->faces[as_index(site)])];
      if (std::find(home.begin(), home.end(), static_cast<std::int32_t>(v)) == home.end())
        doubtful_[as_index(site)].store(1, std::memory_order_relaxed);
    }
  });
}

template <typename Visit>
void FaceMarch::for_each_site_on(OrderedFace face, const Visit& visit) const {
  if (surface_->ordered().counts(face) && has(face))
    for_each_on_border(mesh_, faces_[as_index(face) / FaceEdges::kFaces].cuts, face, visit);
}

/// Sum up the marks of the faces with a piece of these cells.
void FaceMarch::count_pieces() {
  reset(pieces_, sites_->size());
  if (waits_)
    count_pieces_by_labels();
  else
    for (const ChunkParts& chunk : parts_)
      for (const CellPart& part : chunk.cells) pieces_[as_index(part.site)] += part.pieces;
  for (const std::int32_t site : doubts_) {
    const OrderedFace home = sites_->faces[as_index(site)];
    bool on_border = !has_area(home);
    for_each_site_on(home, [&](std::int32_t other) { on_border = on_border || other == site; });
    if (!on_border) pieces_[as_index(site)] += mark_of(home);
  }
}

void FaceMarch::count_pieces_by_labels() {
  parallel_chunks(faces_.size(), 1, [&](std::size_t chunk, std::size_t) {
    const auto count = [&](OrderedFace face) {
      for_each_on_border(mesh_, faces_[chunk].cuts, face, [&](std::int32_t site) {
        if (doubtful_[as_index(site)] == 0) return;
        pieces_[as_index(site)].fetch_add(mark_of(face), std::memory_order_relaxed);
      });
    };
    for (const OrderedFace face : faces_[chunk].whole) count(face);
    for (const OrderedFace face : faces_[chunk].cut) count(face);
  });
}

std::span<const OrderedFace> FaceMarch::disconnected_faces() {
  disconnected_.clear();
  lost_.assign(sites_->size(), -1);
  find_doubtful_sites();
  if (!doubts_.empty()) count_pieces();
  const bool any = !doubts_.empty() && follow_doubtful_sites();
  std::size_t affected = 0;
  if (any) {
    found_.resize(faces_.size());
    parallel_chunks(faces_.size(), 1, [&](std::size_t chunk, std::size_t) {
      find_disconnected(chunk, found_[chunk]);
    });
    for (const std::vector<OrderedFace>& part : found_) {
      affected += part.empty() ? 0 : 1;
      disconnected_.insert(disconnected_.end(), part.begin(), part.end());
    }
  }
  waits_ = kMany * affected > faces_.size();
  return disconnected_;
}

/// Find the connected part of each doubtful cell that is not connected.
/// \return whether there are any
bool FaceMarch::follow_doubtful_sites() {
  reached_.resize(std::max(reached_.size(), doubts_.size()));
  parallel_chunks(doubts_.size(), kFollowGrain, [&](std::size_t begin, std::size_t end) {
    Follower& follower = followers_.local();
    for (std::size_t k = begin; k < end; ++k) {
      if (follow(follower, doubts_[k])) continue;
      lost_[as_index(doubts_[k])] = static_cast<std::int32_t>(k);
      reached_[k].assign(follower.faces.begin(), follower.faces.end());
      std::sort(reached_[k].begin(), reached_[k].end());
    }
  });
  return std::any_of(doubts_.begin(), doubts_.end(),
                     [this](std::int32_t site) { return lost_[as_index(site)] >= 0; });
}

void FaceMarch::find_disconnected(std::size_t chunk, std::vector<OrderedFace>& faces) const {
  const std::size_t first = chunk * FaceEdges::kFaces;
  const std::size_t last = std::min(first + FaceEdges::kFaces, surface_->face_count());
  faces.clear();
  // Once integrated, a chunk knows which cells it meets.
  const auto is_lost = [this](const CellPart& part) { return lost_[as_index(part.site)] >= 0; };
  if (!waits_ && std::ranges::none_of(parts_[chunk].cells, is_lost)) return;
  for (std::size_t f = first; f < last; ++f) {
    bool disconnected = false;
    for_each_site_on(nth_face(f), [&](std::int32_t site) {
      disconnected = disconnected || !is_connected(site, nth_face(f));
    });
    if (disconnected) faces.push_back(nth_face(f));
  }
}

/// Find the faces that a cell reaches from its site over edges. Edges with an end in the cell are
/// crossed first.
/// \return whether these are all of its faces
bool FaceMarch::follow(Follower& follower, std::int32_t site) const {
  const OrderedSurface& mesh = surface_->ordered();
  follower.stamps.resize(surface_->face_count(), 0);
  if (follower.stamp == std::numeric_limits<std::int32_t>::max()) {
    std::fill(follower.stamps.begin(), follower.stamps.end(), 0);
    follower.stamp = 0;
  }
  const std::int32_t stamp = ++follower.stamp;
  std::vector<OrderedFace>& faces = follower.faces;
  faces.clear();
  follower.later.clear();
  const std::uint64_t pieces = pieces_[as_index(site)];
  std::uint64_t marks = 0;
  const auto push = [&](OrderedFace face) {
    if (follower.stamps[as_index(face)] == stamp || !has(face)) return;
    follower.stamps[as_index(face)] = stamp;
    faces.push_back(face);
    if (has_area(face)) marks += mark_of(face);
  };
  const auto cross = [&](std::int32_t h) {
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) push(face_of(g));
  };
  push(sites_->faces[as_index(site)]);
  for (std::size_t next = 0, later = 0; next < faces.size() || later < follower.later.size();) {
    if (next == faces.size()) {
      if (marks == pieces) return true;
      const std::int32_t h = follower.later[later++];
      if (passes(h, site)) cross(h);
      continue;
    }
    const OrderedFace face = faces[next++];
    const Face& corners = edges_->corners()[as_index(face)];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = labels_[as_index(corners[k])].site;
      const std::int32_t b = labels_[as_index(corners[(k + 1) % 3])].site;
      const std::int32_t h = half_edge(face, static_cast<std::int32_t>(k));
      if (a == site || b == site)
        cross(h);
      else if (a != b)
        follower.later.push_back(h);
    }
  }
  return marks == pieces;
}

/// Whether an edge between two other cells passes through that of a site.
bool FaceMarch::passes(std::int32_t half_edge, std::int32_t site) const {
  const std::span<const EdgeCuts::Link> links =
      cuts(face_of(half_edge), static_cast<std::size_t>(half_edge % 3));
  return std::any_of(links.begin(), links.end(),
                     [&](const EdgeCuts::Link& link) { return link.beyond == site; });
}

/// Whether the piece of a cell on a face is connected to its site.
bool FaceMarch::is_connected(std::int32_t site, OrderedFace face) const {
  const std::int32_t lost = lost_[as_index(site)];
  if (lost < 0) return true;
  const std::vector<OrderedFace>& faces = reached_[as_index(lost)];
  return std::binary_search(faces.begin(), faces.end(), face);
}

/// The sites by the face that holds them.
void FaceMarch::find_homes() {
  homes_.clear();
  for (std::size_t k = 0; k < sites_->size(); ++k)
    if (const auto site = static_cast<std::int32_t>(k); lists_.leader(site) == site)
      homes_.emplace_back(sites_->faces[k], site);
  std::sort(homes_.begin(), homes_.end());
}

std::vector<Coverage> FaceMarch::pieces_around(std::span<const OrderedFace> faces) {
  const OrderedSurface& mesh = surface_->ordered();
  find_homes();
  std::vector<OrderedFace> around(faces.begin(), faces.end());
  for (const OrderedFace face : faces)
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(face, k);
      for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g))
        around.push_back(face_of(g));
    }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  std::vector<Coverage> pieces;
  for (const OrderedFace face : around) {
    const double area = moments_[as_index(face)].area;
    const std::size_t first = pieces.size();
    for_each_site_on(face, [&](std::int32_t site) {
      if (is_connected(site, face)) pieces.push_back({site, face, area});
    });
    const auto known = [&](std::int32_t site) {
      return std::any_of(pieces.begin() + static_cast<std::ptrdiff_t>(first), pieces.end(),
                         [site](const Coverage& piece) { return piece.site == site; });
    };
    auto home = std::lower_bound(homes_.begin(), homes_.end(), std::pair{face, std::int32_t{-1}});
    for (; home != homes_.end() && home->first == face; ++home)
      if (!known(home->second)) pieces.push_back({home->second, face, area});
  }
  return pieces;
}

void FaceMarch::sum_cells() {
  cells_.resize(sites_->size());
  for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k] = {static_cast<std::int32_t>(k)};
  for (const ChunkParts& chunk : parts_)
    for (const CellPart& part : chunk.cells)
      add_integrals(cells_[as_index(part.site)].sum, part.sum);
}

/// Sort the contributions to boundaries by cell.
void FaceMarch::sort_sides() {
  first_side_.assign(cells_.size() + 1, 0);
  for (const ChunkParts& chunk : parts_)
    for (const BoundaryPart& part : chunk.boundaries) {
      ++first_side_[as_index(part.first) + 1];
      ++first_side_[as_index(part.second) + 1];
    }
  std::partial_sum(first_side_.begin(), first_side_.end(), first_side_.begin());
  next_side_.assign(first_side_.begin(), first_side_.end());
  sides_.resize(first_side_.back());
  for (std::size_t c = 0; c < parts_.size(); ++c)
    for (std::size_t p = 0; p < parts_[c].boundaries.size(); ++p) {
      const Side side{static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(p)};
      const BoundaryPart& part = parts_[c].boundaries[p];
      sides_[next_side_[as_index(part.first)]++] = side;
      sides_[next_side_[as_index(part.second)]++] = side;
    }
}

/// The number of boundaries of a cell; at most a few too many.
std::size_t FaceMarch::count_row(std::int32_t site) const {
  std::array<std::int32_t, 32> known;
  std::size_t count = 0;
  for (std::size_t s = first_side_[as_index(site)]; s < first_side_[as_index(site) + 1]; ++s) {
    const BoundaryPart& part = parts_[sides_[s].chunk].boundaries[sides_[s].part];
    const std::int32_t other = part.first == site ? part.second : part.first;
    const auto end = known.begin() + static_cast<std::ptrdiff_t>(std::min(count, known.size()));
    if (std::find(known.begin(), end, other) != end) continue;
    if (count < known.size()) known[count] = other;
    ++count;
  }
  return count;
}

/// Merge the contributions to the boundaries of a cell; returns the number of boundaries.
std::size_t FaceMarch::merge_row(std::int32_t site, CellBoundary* out) const {
  std::size_t count = 0;
  for (std::size_t s = first_side_[as_index(site)]; s < first_side_[as_index(site) + 1]; ++s) {
    const BoundaryPart& part = parts_[sides_[s].chunk].boundaries[sides_[s].part];
    const bool is_first = part.first == site;
    const std::int32_t other = is_first ? part.second : part.first;
    const std::int32_t neighbor = sites_->original(other);
    const Triple offset = lists_.position(other) - lists_.position(site);
    // About the second site: x - x_j = (x - x_i) - (x_j - x_i).
    const Triple flux = is_first ? part.flux : part.flux + part.weight * offset;
    const double path = 2.0 * std::sqrt(part.squared_path);
    CellBoundary* const side = std::find_if(
        out, out + count, [neighbor](const CellBoundary& b) { return b.neighbor == neighbor; });
    if (side == out + count) {
      ++count;
      side->neighbor = neighbor;
      flux.store(side->flux);
      offset.store(side->offset);
      side->length = part.length;
      side->path_length = path;
    } else {
      flux.add_to(side->flux);
      side->length += part.length;
      side->path_length = std::min(side->path_length, path);
    }
  }
  return count;
}

void FaceMarch::collect(RestrictedVoronoi& result) {
  sum_cells();
  sort_sides();
  const std::size_t count = cells_.size();
  first_boundary_.resize(count + 1);
  parallel_chunks(count, kSiteGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      first_boundary_[k] = count_row(static_cast<std::int32_t>(k));
  });
  std::size_t total = 0;
  for (std::size_t k = 0; k < count; ++k) total += std::exchange(first_boundary_[k], total);
  first_boundary_[count] = total;
  result.cells.resize(count);
  result.rows.resize(count);
  result.boundaries.resize(total);
  parallel_chunks(count, kSiteGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Integrals& sum = cells_[k].sum;
      const std::size_t original = as_index(sites_->originals[k]);
      Moments& cell = result.cells[original];
      cell.area = std::max(0.0, sum.area);
      cell.capacity = surface_->uniform() ? cell.area : std::max(0.0, sum.capacity);
      cell.mass = surface_->uniform() ? cell.area : std::max(0.0, sum.mass);
      sum.first.store(cell.first);
      cell.second = std::max(0.0, sum.second);
      result.rows[original] = {
          first_boundary_[k],
          merge_row(static_cast<std::int32_t>(k), result.boundaries.data() + first_boundary_[k])};
    }
  });
}

}  // namespace dapple
