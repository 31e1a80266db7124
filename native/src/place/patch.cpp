// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/patch.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "surface/places.hpp"

namespace dapple {
namespace {

struct MeshEdge {
  std::int32_t low, high;  // vertices of the mesh
  auto operator<=>(const MeshEdge&) const = default;
};

/// The vertices of a patch while its pieces are joined.
class Joiner {
 public:
  Joiner(std::span<const Vec3> vertices, std::span<const Face> faces)
      : vertices_(vertices), faces_(faces) {}

  Patch join(std::span<const CellPolygon> pieces, const EdgePoints& others) {
    std::vector<std::vector<std::int32_t>> corners;
    for (const CellPolygon& piece : pieces) {
      std::vector<std::int32_t>& row = corners.emplace_back();
      for (std::size_t k = 0; k < piece.points.size(); ++k) row.push_back(corner(piece, k));
    }
    if (!others.empty()) add_others(pieces, others);
    for (auto& [edge, places] : on_edges_) std::sort(places.begin(), places.end());
    for (std::size_t p = 0; p < pieces.size(); ++p)
      patch_.polygons.push_back({with_points_between(pieces[p], corners[p]), pieces[p].face});
    return std::move(patch_);
  }

  [[nodiscard]] const std::vector<On>& kinds() const { return kinds_; }

  [[nodiscard]] EdgePoints edge_points(std::span<const CellPolygon> pieces) const {
    EdgePoints result;
    for (const CellPolygon& piece : pieces)
      for (std::size_t k = 0; k < piece.points.size(); ++k) {
        const std::int32_t into = piece.edges[(k + piece.edges.size() - 1) % piece.edges.size()];
        const std::int32_t out = piece.edges[k];
        if ((into < 0) == (out < 0)) continue;
        const MeshEdge edge = mesh_edge(piece.face, std::min(into, out));
        result[{edge.low, edge.high}].push_back(piece.points[k]);
      }
    return result;
  }

 private:
  struct Place {
    double at;  // along the edge, from its lower vertex
    std::int32_t vertex;
    auto operator<=>(const Place&) const = default;
  };

  [[nodiscard]] std::int32_t mesh_vertex(std::int32_t face, std::int32_t corner) const {
    return faces_[static_cast<std::size_t>(face)][static_cast<std::size_t>(corner)];
  }
  /// The edge of the mesh that a negative label represents.
  [[nodiscard]] MeshEdge mesh_edge(std::int32_t face, std::int32_t label) const {
    const std::int32_t from = -1 - label;
    const std::int32_t a = mesh_vertex(face, from);
    const std::int32_t b = mesh_vertex(face, (from + 1) % 3);
    return {std::min(a, b), std::max(a, b)};
  }

  std::int32_t corner(const CellPolygon& piece, std::size_t k) {
    const std::int32_t into = piece.edges[(k + piece.edges.size() - 1) % piece.edges.size()];
    const std::int32_t out = piece.edges[k];
    if (into >= 0 && out >= 0) return add(piece.points[k], On::kFace);
    if (into < 0 && out < 0 && (-1 - into + 1) % 3 == -1 - out)
      return on_vertex(mesh_vertex(piece.face, -1 - out));
    return on_edge(mesh_edge(piece.face, out < 0 ? out : into), std::max(into, out),
                   piece.points[k]);
  }

  /// Add the points of other pieces on edges of the mesh along which pieces run.
  void add_others(std::span<const CellPolygon> pieces, const EdgePoints& others) {
    std::set<MeshEdge> done;
    for (const CellPolygon& piece : pieces)
      for (const std::int32_t label : piece.edges) {
        if (label >= 0) continue;
        const MeshEdge edge = mesh_edge(piece.face, label);
        const auto found = others.find({edge.low, edge.high});
        if (found == others.end() || !done.insert(edge).second) continue;
        for (const Vec3& point : found->second)
          on_edges_[edge].push_back({along(edge, point), add(point, On::kEdge)});
      }
  }

  std::int32_t on_vertex(std::int32_t v) {
    const auto [found, isnew] = at_vertices_.try_emplace(v, count());
    if (isnew) add(vertices_[static_cast<std::size_t>(v)], On::kVertex);
    return found->second;
  }

  std::int32_t on_edge(const MeshEdge& edge, std::int32_t plane, const Vec3& point) {
    const auto [found, isnew] = at_planes_.try_emplace({edge, plane}, count());
    if (isnew) on_edges_[edge].push_back({along(edge, point), add(point, On::kEdge)});
    return found->second;
  }

  [[nodiscard]] double along(const MeshEdge& edge, const Vec3& point) const {
    const Vec3& a = vertices_[static_cast<std::size_t>(edge.low)];
    const Vec3 way = vertices_[static_cast<std::size_t>(edge.high)] - a;
    return way.squaredNorm() > 0.0 ? (point - a).dot(way) / way.squaredNorm() : 0.0;
  }

  std::int32_t add(const Vec3& point, On kind) {
    patch_.points.push_back(point);
    kinds_.push_back(kind);
    return count() - 1;
  }
  [[nodiscard]] std::int32_t count() const {
    return static_cast<std::int32_t>(patch_.points.size());
  }

  /// The corners and, between two corners on an edge of the mesh, the points of other pieces on it.
  [[nodiscard]] std::vector<std::int32_t> with_points_between(
      const CellPolygon& piece, std::span<const std::int32_t> corners) const {
    std::vector<std::int32_t> result;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      result.push_back(corners[k]);
      if (piece.edges[k] < 0)
        add_between(mesh_edge(piece.face, piece.edges[k]), corners[k],
                    corners[(k + 1) % corners.size()], result);
    }
    return result;
  }

  void add_between(const MeshEdge& edge, std::int32_t from, std::int32_t to,
                   std::vector<std::int32_t>& result) const {
    const auto places = on_edges_.find(edge);
    if (places == on_edges_.end()) return;
    const double begin = along(edge, patch_.points[static_cast<std::size_t>(from)]);
    const double end = along(edge, patch_.points[static_cast<std::size_t>(to)]);
    std::vector<std::int32_t> between;
    for (const Place& place : places->second)
      if (place.at > std::min(begin, end) && place.at < std::max(begin, end))
        between.push_back(place.vertex);
    if (begin > end) std::reverse(between.begin(), between.end());
    result.insert(result.end(), between.begin(), between.end());
  }

  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  Patch patch_;
  std::vector<On> kinds_;  // per vertex of the patch
  std::map<std::int32_t, std::int32_t> at_vertices_;
  std::map<std::pair<MeshEdge, std::int32_t>, std::int32_t> at_planes_;
  std::map<MeshEdge, std::vector<Place>> on_edges_;
};

struct ShortEdge {
  double squared_length;
  std::int32_t a, b;
  auto operator<=>(const ShortEdge&) const = default;
};

std::vector<ShortEdge> short_edges(const Patch& patch, double shortest) {
  std::vector<ShortEdge> result;
  for (const PatchPolygon& polygon : patch.polygons)
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      const std::int32_t a = polygon.corners[k];
      const std::int32_t b = polygon.corners[(k + 1) % polygon.corners.size()];
      const double length =
          (patch.points[static_cast<std::size_t>(a)] - patch.points[static_cast<std::size_t>(b)])
              .squaredNorm();
      if (length < shortest * shortest) result.push_back({length, std::min(a, b), std::max(a, b)});
    }
  std::sort(result.begin(), result.end());
  return result;
}

/// The vertex into which each vertex collapses. The shortest edges collapse first, and never into a
/// collapsed vertex.
std::vector<std::int32_t> goals(const Patch& patch, std::span<const On> kinds,
                                std::span<const ShortEdge> edges) {
  std::vector<std::int32_t> goal(patch.points.size());
  std::iota(goal.begin(), goal.end(), 0);
  std::vector<bool> settled(patch.points.size(), false);
  for (const auto& [length, a, b] : edges) {
    const auto u = static_cast<std::size_t>(a);
    const auto v = static_cast<std::size_t>(b);
    if (settled[u] || settled[v]) continue;
    settled[u] = settled[v] = true;
    if (kinds[v] < kinds[u])
      goal[u] = b;
    else
      goal[v] = a;
  }
  return goal;
}

/// Add the loops without repeated vertices into which a polygon splits; loops of two corners are
/// dropped.
void add_simple_loops(std::span<const std::int32_t> corners, std::int32_t face,
                      std::vector<PatchPolygon>& result) {
  std::vector<std::int32_t> open;
  for (const std::int32_t corner : corners) {
    const auto seen = std::find(open.begin(), open.end(), corner);
    if (open.end() - seen >= 3) result.push_back({{seen, open.end()}, face});
    open.erase(seen, open.end());
    open.push_back(corner);
  }
  if (open.size() >= 3) result.push_back({std::move(open), face});
}

void keep_simple_loops(Patch& patch) {
  std::vector<PatchPolygon> polygons;
  for (const PatchPolygon& polygon : patch.polygons)
    add_simple_loops(polygon.corners, polygon.face, polygons);
  patch.polygons = std::move(polygons);
}

/// \return the point into which each point has collapsed
std::vector<std::int32_t> remove_short_edges(Patch& patch, std::span<const On> kinds,
                                             double shortest) {
  std::vector<std::int32_t> result(patch.points.size());
  std::iota(result.begin(), result.end(), 0);
  for (std::vector<ShortEdge> edges = short_edges(patch, shortest); !edges.empty();
       edges = short_edges(patch, shortest)) {
    const std::vector<std::int32_t> goal = goals(patch, kinds, edges);
    const auto move = [&goal](std::int32_t& k) { k = goal[static_cast<std::size_t>(k)]; };
    for (PatchPolygon& polygon : patch.polygons) std::ranges::for_each(polygon.corners, move);
    std::ranges::for_each(result, move);
    keep_simple_loops(patch);
  }
  return result;
}

/// Merges all patches and their coincident points.
class Union {
 public:
  Union(std::span<const JoinedPatch> parts, double rounding) {
    for (const JoinedPatch& part : parts) {
      starts_.push_back(points_.size());
      points_.insert(points_.end(), part.patch.points.begin(), part.patch.points.end());
    }
    if (points_.empty()) return;
    add_points(parts, rounding);
    sort_places();
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (const PatchPolygon& polygon : parts[k].patch.polygons) add(k, polygon);
    keep_simple_loops(whole_);
  }

  void remove_short_edges(double shortest) {
    const std::vector<std::int32_t> gone = dapple::remove_short_edges(whole_, kinds_, shortest);
    for (std::int32_t& k : places_) k = gone[static_cast<std::size_t>(k)];
  }

  /// A part after collapsing edges. Its coincident points are merged only if an edge connects them.
  [[nodiscard]] Patch part(std::size_t number, Patch patch) const {
    std::vector<std::int32_t> leader(patch.points.size());
    std::iota(leader.begin(), leader.end(), 0);
    for (const PatchPolygon& polygon : patch.polygons)
      for (std::size_t k = 0; k < polygon.corners.size(); ++k)
        join(number, leader, polygon.corners[k], polygon.corners[(k + 1) % polygon.corners.size()]);
    for (PatchPolygon& polygon : patch.polygons)
      for (std::int32_t& v : polygon.corners) v = leader_of(leader, v);
    for (std::size_t v = 0; v < patch.points.size(); ++v)
      patch.points[v] = whole_.points[static_cast<std::size_t>(place(number, v))];
    keep_simple_loops(patch);
    return patch;
  }

 private:
  void add_points(std::span<const JoinedPatch> parts, double rounding) {
    Places found(points_, rounding);
    std::vector<std::int32_t> numbers(points_.size(), -1);  // of the first point at the place
    for (const JoinedPatch& part : parts)
      for (const On kind : part.kinds) {
        const std::size_t k = places_.size();
        const std::int32_t first = found.find(points_[k]);
        if (first < 0) {
          found.add(static_cast<std::int32_t>(k));
          numbers[k] = static_cast<std::int32_t>(whole_.points.size());
          whole_.points.push_back(points_[k]);
          kinds_.push_back(kind);
          places_.push_back(numbers[k]);
          continue;
        }
        places_.push_back(numbers[static_cast<std::size_t>(first)]);
        settle(static_cast<std::size_t>(places_.back()), kind, points_[k]);
      }
  }
  /// Number the points by position. The numbers decide which of two points stays, independent of
  /// the order of the parts.
  void sort_places() {
    std::vector<std::size_t> order(whole_.points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
      const Vec3 &p = whole_.points[a], &q = whole_.points[b];
      return std::tuple(p[0], p[1], p[2], a) < std::tuple(q[0], q[1], q[2], b);
    });
    std::vector<std::int32_t> number(order.size());
    std::vector<Vec3> points;
    std::vector<On> kinds;
    for (const std::size_t place : order) {
      number[place] = static_cast<std::int32_t>(points.size());
      points.push_back(whole_.points[place]);
      kinds.push_back(kinds_[place]);
    }
    for (std::int32_t& place : places_) place = number[static_cast<std::size_t>(place)];
    whole_.points = std::move(points);
    kinds_ = std::move(kinds);
  }
  /// Use the position of the point with the higher priority.
  void settle(std::size_t place, On kind, const Vec3& point) {
    if (kind >= kinds_[place]) return;
    kinds_[place] = kind;
    whole_.points[place] = point;
  }

  void add(std::size_t number, const PatchPolygon& polygon) {
    PatchPolygon moved{{}, polygon.face};
    for (const std::int32_t v : polygon.corners)
      moved.corners.push_back(place(number, static_cast<std::size_t>(v)));
    whole_.polygons.push_back(std::move(moved));
  }

  [[nodiscard]] std::int32_t place(std::size_t number, std::size_t v) const {
    return places_[starts_[number] + v];
  }

  static std::int32_t leader_of(std::span<std::int32_t> leader, std::int32_t v) {
    while (leader[static_cast<std::size_t>(v)] != v) v = leader[static_cast<std::size_t>(v)];
    return v;
  }

  void join(std::size_t number, std::span<std::int32_t> leader, std::int32_t a,
            std::int32_t b) const {
    if (place(number, static_cast<std::size_t>(a)) != place(number, static_cast<std::size_t>(b)))
      return;
    const auto [low, high] = std::minmax({leader_of(leader, a), leader_of(leader, b)});
    leader[static_cast<std::size_t>(high)] = low;
  }

  std::vector<std::size_t> starts_;   // per part, the index of its first point
  std::vector<Vec3> points_;          // of all parts
  std::vector<std::int32_t> places_;  // per point of a part, its index in the whole
  Patch whole_;
  std::vector<On> kinds_;  // per point of the whole
};

}  // namespace

EdgePoints PatchBuilder::edge_points(std::span<const CellPolygon> pieces) const {
  return Joiner(vertices_, faces_).edge_points(pieces);
}

JoinedPatch PatchBuilder::build(std::span<const CellPolygon> pieces,
                                const EdgePoints& others) const {
  Joiner joiner(vertices_, faces_);
  Patch patch = joiner.join(pieces, others);
  keep_simple_loops(patch);  // two crossings of the same plane and edge are one vertex
  return {std::move(patch), joiner.kinds()};
}

Patch without_short_edges(JoinedPatch joined, double shortest) {
  remove_short_edges(joined.patch, joined.kinds, shortest);
  return std::move(joined.patch);
}

std::vector<Patch> without_short_edges(std::vector<JoinedPatch> joined, double shortest,
                                       double rounding) {
  Union whole(joined, rounding);
  whole.remove_short_edges(shortest);
  std::vector<Patch> result;
  for (std::size_t k = 0; k < joined.size(); ++k)
    result.push_back(whole.part(k, std::move(joined[k].patch)));
  return result;
}

}  // namespace dapple
