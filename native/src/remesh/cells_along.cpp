// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/cells_along.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <limits>
#include <numeric>
#include <queue>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "lines/line_edges.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 64;    // sites
constexpr std::size_t kFaces = 1024;  // per chunk
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kOnEdge = 1e-9;    // a barycentric coordinate: the place is on the edge opposite
constexpr double kNothing = 1e-13;  // of a face: a part that is rounding
// Of the squared spacing: up to so much is added to all squared distances of a site, another for
// each, or sites that mirror each other on a symmetric surface would have their border on edges.
constexpr double kLead = 1e-7;
constexpr double kGolden = 0.6180339887498949;
constexpr double kLess = 1.0 - 1e-12;  // of a distance: a shorter one that is no rounding
constexpr double kBothWays = 2.0;  // longest edges by which a site may be farther than the nearest

std::int32_t next_corner(std::int32_t h) { return h - h % 3 + (h + 1) % 3; }
std::int32_t last_corner(std::int32_t h) { return h - h % 3 + (h + 2) % 3; }

/// The distance of c from the place that has these distances from a and b and lies beyond their
/// edge, if the straight way to c crosses that.
double across(const Vec3& a, const Vec3& b, const Vec3& c, double from_a, double from_b) {
  const double length = (b - a).norm();
  if (length == 0.0) return kFar;
  const Vec3 along = (b - a) / length;
  const double x = along.dot(c - a), y = (c - a - x * along).norm();
  const double sx = 0.5 * (from_a * from_a - from_b * from_b + length * length) / length;
  const double square = from_a * from_a - sx * sx;
  if (square < 0.0) return kFar;
  const double sy = std::sqrt(square);
  if (sy + y == 0.0) return kFar;
  const double crossing = sx + (x - sx) * sy / (sy + y);
  if (crossing < 0.0 || crossing > length) return kFar;
  return std::sqrt((x - sx) * (x - sx) + (y + sy) * (y + sy));
}

}  // namespace

/// Distances along the surface from one site, or from each place's nearest one.
class CellsAlong::Flood {
 public:
  explicit Flood(const CellsAlong& cells)
      : cells_(cells), distances_(cells.node_count(), kFar), sites_(cells.node_count(), -1) {}

  void clear() {
    for (const std::int32_t node : touched_) distances_[as_index(node)] = kFar;
    touched_.clear();
    front_ = 0.0;
  }

  void start(const Sites& sites, std::size_t site) {
    for (const std::int32_t corner : cells_.start_of_flood(sites, site)) {
      const std::int32_t node = cells_.node(corner);
      offer(node, static_cast<std::int32_t>(site),
            (cells_.position(node) - sites.positions[site]).norm());
    }
  }

  /// \param limit called with a node: how far it may be
  template <typename Limit>
  void run(const Limit& limit) {
    for (; !open_.empty(); std::swap(open_, later_)) {
      front_ = 0.0;
      while (!open_.empty()) {
        const auto [distance, node] = open_.top();
        open_.pop();
        if (distance > distances_[as_index(node)]) continue;
        front_ = distance;
        for (const std::int32_t corner : cells_.corners_at(node)) pass_on(corner, limit);
      }
    }
  }

  [[nodiscard]] std::span<const std::int32_t> touched() const { return touched_; }
  [[nodiscard]] double distance(std::int32_t node) const { return distances_[as_index(node)]; }
  [[nodiscard]] std::vector<double>& distances() { return distances_; }

 private:
  using Entry = std::pair<double, std::int32_t>;  // distance, node
  using Queue = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

  void offer(std::int32_t node, std::int32_t site, double distance) {
    double& known = distances_[as_index(node)];
    if (!(distance < kLess * known)) return;
    if (known == kFar) touched_.push_back(node);
    known = distance;
    sites_[as_index(node)] = site;
    (distance < front_ ? later_ : open_).push({distance, node});
  }

  /// From the corner of a face to the others. They may have been reached before: a straight way
  /// can cross an edge one of whose ends is farther away.
  template <typename Limit>
  void pass_on(std::int32_t corner, const Limit& limit) {
    const std::int32_t a = cells_.node(corner), b = cells_.node(next_corner(corner)),
                       c = cells_.node(last_corner(corner));
    pass_on(a, b, c, limit);
    pass_on(a, c, b, limit);
  }

  /// From a, or across the edge from a to b, to c.
  template <typename Limit>
  void pass_on(std::int32_t a, std::int32_t b, std::int32_t c, const Limit& limit) {
    const Vec3 &at = cells_.position(a), &to = cells_.position(c);
    const std::int32_t site = sites_[as_index(a)];
    double least = distance(a) + (to - at).norm();
    if (distance(b) < kFar && sites_[as_index(b)] == site)
      least = std::min(least, across(at, cells_.position(b), to, distance(a), distance(b)));
    if (least <= limit(c)) offer(c, site, least);
  }

  const CellsAlong& cells_;
  std::vector<double> distances_;
  std::vector<std::int32_t> sites_;
  std::vector<std::int32_t> touched_;
  // A way across an edge may reach a node nearer than the front has come. Such nodes wait for the
  // next sweep: gone on from at once, they would be reached anew for each of many nearer ways
  // along needles.
  Queue open_, later_;
  double front_ = 0.0;  // the distance that the sweep has come to
};

CellsAlong::CellsAlong(const Surface& surface) : surface_(surface), mesh_(surface.ordered()) {
  find_nodes();
  index_corners();
}

/// Faces around a vertex that are connected over edges share a node.
void CellsAlong::find_nodes() {
  const auto halves = static_cast<std::int32_t>(3 * surface_.face_count());
  Sets fans = fans_of(mesh_);
  nodes_.resize(as_index(halves));
  std::int32_t count = 0;
  for (std::int32_t h = 0; h < halves; ++h) {
    const std::int32_t root = fans.find(h);
    nodes_[as_index(h)] = root == h ? count++ : nodes_[as_index(root)];
  }
  rows_.assign(as_index(count) + 1, 0);
}

void CellsAlong::index_corners() {
  const auto halves = static_cast<std::int32_t>(nodes_.size());
  for (std::int32_t h = 0; h < halves; ++h) ++rows_[as_index(node(h)) + 1];
  std::partial_sum(rows_.begin(), rows_.end(), rows_.begin());
  corners_.resize(nodes_.size());
  std::vector<std::size_t> next(rows_.begin(), rows_.end() - 1);
  for (std::int32_t h = 0; h < halves; ++h) corners_[next[as_index(node(h))]++] = h;
  reach_.assign(node_count(), 0.0);
  for (std::int32_t h = 0; h < halves; ++h) {
    const double length = (position(node(next_corner(h))) - position(node(h))).norm();
    for (const std::int32_t corner : {h, next_corner(h), last_corner(h)})
      reach_[as_index(node(corner))] = std::max(reach_[as_index(node(corner))], length);
  }
}

/// The corners of the faces that a site touches.
std::vector<std::int32_t> CellsAlong::start_of_flood(const Sites& sites, std::size_t site) const {
  const OrderedFace face = mesh_.counted_face(sites.faces[site]);
  const auto [a, b, c] = mesh_.corners(face);
  const Vec3 weights = mesh_.counts(mesh_.ordered_face(sites.faces[site]))
                           ? sites.barycentric[site]
                           : closest_barycentric(sites.positions[site], mesh_.vertex(a),
                                                 mesh_.vertex(b), mesh_.vertex(c));
  std::vector<std::int32_t> result;
  const auto add = [&](std::int32_t h) {
    for (std::int32_t k = 0; k < 3; ++k) result.push_back(half_edge(face_of(h), k));
  };
  add(half_edge(face, 0));
  for (std::int32_t k = 0; k < 3; ++k) {
    const auto on = [&](std::int32_t edge) { return weights[(edge + 2) % 3] < kOnEdge; };
    const std::int32_t h = half_edge(face, k);
    if (on(k))
      for (std::int32_t g = mesh_.next_around(h); g != h; g = mesh_.next_around(g)) add(g);
    if (on(k) && on((k + 2) % 3))
      for (const std::int32_t corner : corners_at(node(h))) add(corner);
  }
  return result;
}

/// The distance from each node to a site: at most a little more than to the nearest.
std::vector<double> CellsAlong::nearest(const Sites& sites, Context* context) const {
  Flood flood(*this);
  for (std::size_t s = 0; s < sites.size(); ++s) {
    check_at(context, s);
    flood.start(sites, s);
  }
  flood.run([](std::int32_t) { return kFar; });
  return std::move(flood.distances());
}

CellsAlong::Table CellsAlong::measure(const Sites& sites, Context* context) const {
  const std::vector<double> least = nearest(sites, context);
  const double spacing = surface_.spacing(sites.size());
  const double unit = kLead * spacing * spacing;
  struct Entry {
    std::int32_t node;
    Distance distance;
  };
  std::vector<std::vector<Entry>> found((sites.size() + kGrain - 1) / kGrain);
  tbb::enumerable_thread_specific<Flood> floods([this] { return Flood(*this); });
  parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    Flood& flood = floods.local();
    for (std::size_t s = begin; s < end; ++s) {
      flood.start(sites, s);
      flood.run([&](std::int32_t node) {
        return least[as_index(node)] + kBothWays * reach_[as_index(node)];
      });
      const double lead = unit * std::fmod(kGolden * static_cast<double>(s), 1.0);
      for (const std::int32_t node : flood.touched()) {
        const double distance = flood.distance(node);
        found[begin / kGrain].push_back(
            {node, {static_cast<std::int32_t>(s), distance * distance + lead}});
      }
      flood.clear();
    }
  });
  Table table;
  table.rows.assign(node_count() + 1, 0);
  for (const auto& chunk : found)
    for (const Entry& entry : chunk) ++table.rows[as_index(entry.node) + 1];
  std::partial_sum(table.rows.begin(), table.rows.end(), table.rows.begin());
  table.values.resize(table.rows.back());
  std::vector<std::size_t> next(table.rows.begin(), table.rows.end() - 1);
  for (const auto& chunk : found)
    for (const Entry& entry : chunk) table.values[next[as_index(entry.node)]++] = entry.distance;
  return table;
}

/// Per component without sites the site nearest to one of its faces; -1 for the others.
std::vector<std::int32_t> CellsAlong::owners_of_components(const Sites& sites) const {
  std::vector<std::int32_t> owners(as_index(mesh_.components()), -2);
  for (const std::int32_t face : sites.faces)
    owners[as_index(mesh_.component(mesh_.counted_face(face)))] = -1;
  if (std::ranges::find(owners, -2) == owners.end()) return owners;
  const Neighbors tree(sites.positions);
  std::vector<Neighbor> nearest;
  for (std::size_t f = 0; f < surface_.face_count(); ++f) {
    std::int32_t& owner = owners[as_index(mesh_.component(nth_face(f)))];
    if (owner != -2) continue;
    tree.nearest(mesh_.vertex(mesh_.corners(nth_face(f))[0]), 1, nearest);
    owner = nearest[0].index;
  }
  return owners;
}

namespace {

/// A site that may own a part of a face: its squared distances at the corners.
struct Rival {
  std::int32_t site;
  Vec3 squares;
};

/// Leave out sites that are farther than another everywhere.
void drop_hopeless(std::vector<Rival>& rivals) {
  std::vector<Rival> left;
  for (const Rival& rival : rivals) {
    const bool hopeless = std::ranges::any_of(rivals, [&](const Rival& other) {
      return (other.squares - rival.squares).maxCoeff() < 0.0 ||
             (other.squares == rival.squares && other.site < rival.site);
    });
    if (!hopeless) left.push_back(rival);
  }
  rivals = std::move(left);
}

struct Point {
  Vec3 weights;
  std::int32_t edge;  // to the next point, see CellPolygon
};

/// Twice the area of a polygon in barycentric coordinates.
double extent(std::span<const Point> polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += (polygon[k - 1].weights - polygon[0].weights)
               .cross(polygon[k].weights - polygon[0].weights);
  return sum.norm();
}

/// Keep the part where a linear function is not above 0.
void cut(const Vec3& values, std::int32_t rival, std::vector<Point>& polygon) {
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &here = polygon[k], &next = polygon[(k + 1) % polygon.size()];
    const double a = values.dot(here.weights), b = values.dot(next.weights);
    const bool inside = a <= 0.0, goes_on = b <= 0.0;
    if (inside) kept.push_back(here);
    if (inside != goes_on)
      kept.push_back(
          {here.weights + a / (a - b) * (next.weights - here.weights), inside ? rival : here.edge});
  }
  polygon = std::move(kept);
}

}  // namespace

/// Divide a face among the sites whose distances are known at all of its corners.
void CellsAlong::divide(OrderedFace face, const Table& table,
                        std::vector<CellPolygon>& result) const {
  const std::array<std::span<const Distance>, 3> at = {table.at(node(half_edge(face, 0))),
                                                       table.at(node(half_edge(face, 1))),
                                                       table.at(node(half_edge(face, 2)))};
  std::vector<Rival> rivals;
  std::size_t b = 0, c = 0;
  for (const Distance& first : at[0]) {
    while (b < at[1].size() && at[1][b].site < first.site) ++b;
    while (c < at[2].size() && at[2][c].site < first.site) ++c;
    if (b < at[1].size() && c < at[2].size() && at[1][b].site == first.site &&
        at[2][c].site == first.site)
      rivals.push_back({first.site, Vec3(first.squared, at[1][b].squared, at[2][c].squared)});
  }
  drop_hopeless(rivals);
  for (const Rival& rival : rivals) {
    std::vector<Point> polygon = {{Vec3::UnitX(), -1}, {Vec3::UnitY(), -2}, {Vec3::UnitZ(), -3}};
    for (const Rival& other : rivals)
      if (other.site != rival.site) cut(rival.squares - other.squares, other.site, polygon);
    if (extent(polygon) <= kNothing) continue;
    CellPolygon piece{rival.site, mesh_.original_face(face), {}, {}};
    for (const Point& point : polygon) {
      piece.points.push_back(mesh_.point(face, point.weights));
      piece.edges.push_back(point.edge);
    }
    result.push_back(std::move(piece));
  }
}

std::vector<CellPolygon> CellsAlong::polygons(const Sites& sites, Context* context) const {
  if (sites.size() == 0) return {};
  const Table table = measure(sites, context);
  const std::vector<std::int32_t> owners = owners_of_components(sites);
  std::vector<std::vector<CellPolygon>> chunks((surface_.face_count() + kFaces - 1) / kFaces);
  parallel_chunks(surface_.face_count(), kFaces, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    std::vector<CellPolygon>& chunk = chunks[begin / kFaces];
    for (std::size_t f = begin; f < end; ++f) {
      const OrderedFace face = nth_face(f);
      if (!mesh_.counts(face)) continue;
      const std::int32_t owner = owners[as_index(mesh_.component(face))];
      if (owner < 0) {
        divide(face, table, chunk);
        continue;
      }
      CellPolygon piece{owner, mesh_.original_face(face), {}, {-1, -2, -3}};
      for (const std::int32_t corner : mesh_.corners(face))
        piece.points.push_back(mesh_.vertex(corner));
      chunk.push_back(std::move(piece));
    }
  });
  std::vector<CellPolygon> result;
  for (auto& chunk : chunks) std::ranges::move(chunk, std::back_inserter(result));
  std::ranges::stable_sort(result, {}, &CellPolygon::site);
  return result;
}

}  // namespace dapple
