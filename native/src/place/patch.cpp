// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/patch.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace dapple {
namespace {

/// What a vertex of a patch lies on; of two that become one the stronger stays.
enum class On { kVertex, kEdge, kFace };

struct MeshEdge {
  std::int32_t low, high;  // vertices of the mesh
  auto operator<=>(const MeshEdge&) const = default;
};

/// The vertices of a patch while its pieces are joined.
class Joiner {
 public:
  Joiner(std::span<const Vec3> vertices, std::span<const Face> faces)
      : vertices_(vertices), faces_(faces) {}

  Patch join(std::span<const CellPolygon> pieces) {
    std::vector<std::vector<std::int32_t>> corners;
    for (const CellPolygon& piece : pieces) {
      std::vector<std::int32_t>& row = corners.emplace_back();
      for (std::size_t k = 0; k < piece.points.size(); ++k) row.push_back(corner(piece, k));
    }
    for (auto& [edge, places] : on_edges_) std::sort(places.begin(), places.end());
    for (std::size_t p = 0; p < pieces.size(); ++p)
      patch_.polygons.push_back({with_points_between(pieces[p], corners[p]), pieces[p].face});
    return std::move(patch_);
  }

  [[nodiscard]] const std::vector<On>& kinds() const { return kinds_; }

 private:
  struct Place {
    double at;  // along the edge, from its lower vertex
    std::int32_t vertex;
    auto operator<=>(const Place&) const = default;
  };

  [[nodiscard]] std::int32_t mesh_vertex(std::int32_t face, std::int32_t corner) const {
    return faces_[static_cast<std::size_t>(face)][static_cast<std::size_t>(corner)];
  }
  /// The edge of the mesh that a label below 0 names.
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

  /// The corners and, between two on an edge of the mesh, whatever other pieces have there.
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

std::vector<ShortEdge> short_edges(const Patch& patch, double tolerance) {
  std::vector<ShortEdge> result;
  for (const PatchPolygon& polygon : patch.polygons)
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      const std::int32_t a = polygon.corners[k];
      const std::int32_t b = polygon.corners[(k + 1) % polygon.corners.size()];
      const double length =
          (patch.points[static_cast<std::size_t>(a)] - patch.points[static_cast<std::size_t>(b)])
              .squaredNorm();
      if (length < tolerance * tolerance)
        result.push_back({length, std::min(a, b), std::max(a, b)});
    }
  std::sort(result.begin(), result.end());
  return result;
}

/// Into which vertex each goes; shortest edges first, none into one that went itself.
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

/// The loops without a repeated vertex that a polygon falls into; those of two corners vanish.
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

void remove_short_edges(Patch& patch, std::span<const On> kinds, double tolerance) {
  for (std::vector<ShortEdge> edges = short_edges(patch, tolerance); !edges.empty();
       edges = short_edges(patch, tolerance)) {
    const std::vector<std::int32_t> goal = goals(patch, kinds, edges);
    for (PatchPolygon& polygon : patch.polygons)
      for (std::int32_t& corner : polygon.corners) corner = goal[static_cast<std::size_t>(corner)];
    keep_simple_loops(patch);
  }
}

}  // namespace

Patch PatchBuilder::build(std::span<const CellPolygon> pieces, double tolerance) const {
  Joiner joiner(vertices_, faces_);
  Patch patch = joiner.join(pieces);
  keep_simple_loops(patch);  // two crossings of one plane and one edge are one vertex
  remove_short_edges(patch, joiner.kinds(), tolerance);
  return patch;
}

}  // namespace dapple
