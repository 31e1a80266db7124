// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/tile.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "base/elementary.hpp"
#include "surface/border_loops.hpp"
#include "surface/openmesh.hpp"

namespace dapple {
namespace {

constexpr double kFlat = 1e-6;       // radians: faces at less lie in one plane, edges in one line
constexpr double kLongestMitre = 2;  // in thicknesses

using Corners = std::vector<std::int32_t>;

const Vec3& point(const Patch& patch, std::int32_t v) {
  return patch.points[static_cast<std::size_t>(v)];
}

/// Sets of corners of all polygons (union-find).
class CornerSets {
 public:
  explicit CornerSets(const Patch& patch) {
    first_.push_back(0);
    for (const PatchPolygon& polygon : patch.polygons)
      first_.push_back(first_.back() + polygon.corners.size());
    parent_.resize(first_.back());
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  [[nodiscard]] std::size_t corner(std::size_t polygon, std::size_t k) const {
    const std::size_t size = first_[polygon + 1] - first_[polygon];
    return first_[polygon] + k % size;
  }
  [[nodiscard]] std::size_t size() const { return parent_.size(); }
  std::size_t find(std::size_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void unite(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::size_t> parent_;
};

/// One run of a polygon along an edge.
struct EdgeUse {
  std::int32_t low, high;  // vertices
  std::size_t polygon, k;
  bool upward;  // whether it runs from the lower vertex to the higher one
  auto operator<=>(const EdgeUse&) const = default;

  [[nodiscard]] bool same_edge(const EdgeUse& other) const {
    return low == other.low && high == other.high;
  }
};

/// Sorted, so that those of one edge are consecutive.
std::vector<EdgeUse> edge_uses(const Patch& patch) {
  std::vector<EdgeUse> result;
  for (std::size_t p = 0; p < patch.polygons.size(); ++p) {
    const Corners& corners = patch.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::int32_t a = corners[k];
      const std::int32_t b = corners[(k + 1) % corners.size()];
      result.push_back({std::min(a, b), std::max(a, b), p, k, a < b});
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// Call visit(uses) for each edge.
template <typename Visit>
void for_each_edge(std::span<const EdgeUse> uses, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].same_edge(uses[begin])) ++end;
    visit(uses.subspan(begin, end - begin));
  }
}

/// The half-edge mesh of a separated patch; handles of vertices and faces are indices of the patch.
PolygonMesh half_edge_mesh(const Patch& patch) {
  PolygonMesh mesh;
  for (const Vec3& p : patch.points) mesh.add_vertex({p.x(), p.y(), p.z()});
  std::vector<PolygonMesh::VertexHandle> corners;
  for (const PatchPolygon& polygon : patch.polygons) {
    corners.clear();
    for (const std::int32_t v : polygon.corners)
      corners.push_back(mesh.vertex_handle(static_cast<unsigned>(v)));
    mesh.add_face(corners);
  }
  return mesh;
}

std::size_t index_of(const PolygonMesh& mesh, PolygonMesh::HalfedgeHandle h) {
  return static_cast<std::size_t>(mesh.face_handle(h).idx());
}

bool same_direction(const Vec3& a, const Vec3& b) {
  return a.dot(b) > 0.0 && a.cross(b).norm() <= kFlat * a.norm() * b.norm();
}

/// Sets of connected polygons in one plane, each identified by its first polygon.
class FlatSets {
 public:
  FlatSets(const Patch& patch, const PolygonMesh& mesh)
      : mesh_(mesh), set_(patch.polygons.size(), -1) {
    for (const PatchPolygon& polygon : patch.polygons)
      normals_.push_back(twice_area_vector(patch, polygon));
    for (std::size_t p = 0; p < set_.size(); ++p)
      if (set_[p] < 0) grow(p);
  }

  [[nodiscard]] bool is_inner(PolygonMesh::HalfedgeHandle h) const {
    const auto other = mesh_.opposite_halfedge_handle(h);
    return !mesh_.is_boundary(other) && set_[index_of(mesh_, h)] == set_[index_of(mesh_, other)];
  }
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& sets() const { return sets_; }

 private:
  void grow(std::size_t first) {
    std::vector<std::size_t>& members = sets_.emplace_back();
    const auto take = [&](std::size_t p) {
      set_[p] = static_cast<std::int32_t>(first);
      members.push_back(p);
    };
    take(first);
    for (std::size_t m = 0; m < members.size(); ++m) {
      const auto face = mesh_.face_handle(static_cast<unsigned>(members[m]));
      for (auto h = mesh_.cfh_iter(face); h.is_valid(); ++h) {
        const auto other = mesh_.opposite_halfedge_handle(*h);
        if (mesh_.is_boundary(other)) continue;
        const std::size_t p = index_of(mesh_, other);
        if (set_[p] < 0 && same_direction(normals_[first], normals_[p])) take(p);
      }
    }
  }

  const PolygonMesh& mesh_;
  std::vector<Vec3> normals_;
  std::vector<std::int32_t> set_;
  std::vector<std::vector<std::size_t>> sets_;
};

/// The border loop of a set; empty if the set has several loops or the loop meets itself.
Corners outline(const PolygonMesh& mesh, const FlatSets& flat,
                std::span<const std::size_t> members) {
  std::vector<PolygonMesh::HalfedgeHandle> border;
  for (const std::size_t p : members) {
    const auto face = mesh.face_handle(static_cast<unsigned>(p));
    for (auto h = mesh.cfh_iter(face); h.is_valid(); ++h)
      if (!flat.is_inner(*h)) border.push_back(*h);
  }
  if (border.empty()) return {};
  Corners result;
  auto h = border.front();
  do {
    result.push_back(mesh.from_vertex_handle(h).idx());
    h = mesh.next_halfedge_handle(h);
    while (flat.is_inner(h)) h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
  } while (h != border.front() && result.size() <= border.size());
  Corners sorted = result;
  std::sort(sorted.begin(), sorted.end());
  const bool simple = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  return simple && result.size() == border.size() ? result : Corners();
}

/// Whether a vertex lies inside a straight edge of one polygon or between the same two polygons.
std::vector<bool> in_straight_edges(const Patch& patch) {
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> uses(patch.points.size());
  for (const auto& [corners, face] : patch.polygons)
    for (std::size_t k = 0; k < corners.size(); ++k)
      uses[static_cast<std::size_t>(corners[k])].emplace_back(
          corners[(k + corners.size() - 1) % corners.size()], corners[(k + 1) % corners.size()]);
  std::vector<bool> result(patch.points.size(), false);
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v].empty() || uses[v].size() > 2) continue;
    const auto [before, after] = uses[v].front();
    if (uses[v].size() == 2 && uses[v].back() != std::pair(after, before)) continue;
    result[v] = same_direction(patch.points[v] - point(patch, before),
                               point(patch, after) - patch.points[v]);
  }
  return result;
}

/// The offset of each vertex that raises the polygons around it by 1. It points along the mean of
/// their normals and is longer where the normals differ.
std::vector<Vec3> lifts(const Patch& patch) {
  std::vector<Vec3> result(patch.points.size(), Vec3::Zero());
  std::vector<double> least(patch.points.size(), 1.0);
  const auto for_each_corner = [&](const auto& visit) {
    for (const PatchPolygon& polygon : patch.polygons) {
      const Vec3 normal = twice_area_vector(patch, polygon).normalized();
      for (std::size_t k = 0; k < polygon.corners.size(); ++k) visit(polygon.corners, k, normal);
    }
  };
  for_each_corner([&](const Corners& corners, std::size_t k, const Vec3& normal) {
    const Vec3 in =
        point(patch, corners[k]) - point(patch, corners[(k + corners.size() - 1) % corners.size()]);
    const Vec3 out = point(patch, corners[(k + 1) % corners.size()]) - point(patch, corners[k]);
    const double angle = angle_of(in.cross(out).norm(), -in.dot(out));  // inside the polygon
    result[static_cast<std::size_t>(corners[k])] += angle * normal;
  });
  for (Vec3& lift : result) lift.normalize();
  for_each_corner([&](const Corners& corners, std::size_t k, const Vec3& normal) {
    const auto v = static_cast<std::size_t>(corners[k]);
    least[v] = std::min(least[v], normal.isZero() ? 1.0 : result[v].dot(normal));
  });
  for (std::size_t v = 0; v < result.size(); ++v)
    result[v] /= std::max(least[v], 1.0 / kLongestMitre);
  return result;
}

void add_bottom(const Patch& patch, std::int32_t offset, TileMesh& result) {
  for (const auto& [corners, face] : patch.polygons) {
    Corners turned(corners.rbegin(), corners.rend());
    for (std::int32_t& v : turned) v += offset;
    result.patch.polygons.push_back({std::move(turned), face});
    result.sides.push_back(TileSide::kBottom);
  }
}

/// Add a wall under every edge of a border loop, facing outward, in the order of the polygons.
void add_walls(const Patch& patch, std::int32_t offset, TileMesh& result) {
  std::vector<std::pair<std::size_t, std::size_t>> walls;  // polygons and their edges
  for_each_edge(edge_uses(patch), [&](std::span<const EdgeUse> uses) {
    if (uses.size() == 1) walls.emplace_back(uses[0].polygon, uses[0].k);
  });
  std::sort(walls.begin(), walls.end());
  for (const auto& [p, k] : walls) {
    const auto& [corners, face] = patch.polygons[p];
    const std::int32_t a = corners[k];
    const std::int32_t b = corners[(k + 1) % corners.size()];
    result.patch.polygons.push_back({{a + offset, b + offset, b, a}, face});
    result.sides.push_back(TileSide::kWall);
  }
}

PatchTopology topology_of(const Patch& patch, const PolygonMesh& mesh) {
  PatchTopology result;
  result.loops = count_border_loops(mesh);
  std::vector<bool> reached(patch.polygons.size(), false);
  std::vector<std::size_t> pending;
  for (std::size_t p = 0; p < reached.size(); ++p) {
    if (reached[p]) continue;
    ++result.parts;
    reached[p] = true;
    for (pending = {p}; !pending.empty();) {
      const auto face = mesh.face_handle(static_cast<unsigned>(pending.back()));
      pending.pop_back();
      for (auto next = mesh.cff_iter(face); next.is_valid(); ++next) {
        const auto q = static_cast<std::size_t>(next->idx());
        if (!reached[q]) pending.push_back(q);
        reached[q] = true;
      }
    }
  }
  return result;
}

}  // namespace

Vec3 twice_area_vector(const Patch& patch, const PatchPolygon& polygon) {
  Vec3 result = Vec3::Zero();
  const Vec3& first = point(patch, polygon.corners[0]);
  for (std::size_t k = 2; k < polygon.corners.size(); ++k)
    result += (point(patch, polygon.corners[k - 1]) - first)
                  .cross(point(patch, polygon.corners[k]) - first);
  return result;
}

Patch apart(const Patch& patch) {
  CornerSets sets(patch);
  for_each_edge(edge_uses(patch), [&](std::span<const EdgeUse> uses) {
    if (uses.size() != 2 || uses[0].upward == uses[1].upward) return;
    const EdgeUse &one = uses[0], &other = uses[1];
    sets.unite(sets.corner(one.polygon, one.k), sets.corner(other.polygon, other.k + 1));
    sets.unite(sets.corner(one.polygon, one.k + 1), sets.corner(other.polygon, other.k));
  });
  Patch result;
  std::vector<std::int32_t> vertices(sets.size(), -1);  // of the sets
  result.polygons.reserve(patch.polygons.size());
  for (std::size_t p = 0; p < patch.polygons.size(); ++p) {
    PatchPolygon polygon = patch.polygons[p];
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      std::int32_t& vertex = vertices[sets.find(sets.corner(p, k))];
      if (vertex < 0) {
        vertex = static_cast<std::int32_t>(result.points.size());
        result.points.push_back(point(patch, polygon.corners[k]));
      }
      polygon.corners[k] = vertex;
    }
    result.polygons.push_back(std::move(polygon));
  }
  return result;
}

FlatPatch flattened(const Patch& patch, bool merge) {
  const PolygonMesh mesh = half_edge_mesh(patch);
  FlatPatch result;  // member by member: GCC 12 frees the first twice if a later one throws
  result.topology = topology_of(patch, mesh);
  if (!merge) {
    result.patch = patch;
    return result;
  }
  result.patch.points = patch.points;
  const FlatSets flat(patch, mesh);
  for (const auto& members : flat.sets()) {
    Corners loop = members.size() > 1 ? outline(mesh, flat, members) : Corners();
    if (!loop.empty())
      result.patch.polygons.push_back({std::move(loop), patch.polygons[members.front()].face});
    else
      for (const std::size_t p : members) result.patch.polygons.push_back(patch.polygons[p]);
  }
  result.straight = in_straight_edges(result.patch);
  return result;
}

std::vector<std::int32_t> kept_corners(const FlatPatch& flat, const PatchPolygon& polygon) {
  Corners kept;
  for (const std::int32_t v : polygon.corners)
    if (!flat.straight[static_cast<std::size_t>(v)]) kept.push_back(v);
  return kept.size() < 3 ? polygon.corners : kept;
}

Patch without_straight(FlatPatch flat) {
  if (flat.straight.empty()) return std::move(flat.patch);
  for (PatchPolygon& polygon : flat.patch.polygons) polygon.corners = kept_corners(flat, polygon);
  return apart(flat.patch);  // removes unused vertices
}

TileMesh raised(const Patch& patch, double thickness) {
  TileMesh result{patch, std::vector<TileSide>(patch.polygons.size(), TileSide::kTop)};
  if (thickness == 0.0) return result;
  const std::vector<Vec3> lift = lifts(patch);
  for (std::size_t v = 0; v < lift.size(); ++v) result.patch.points[v] += thickness * lift[v];
  const auto offset = static_cast<std::int32_t>(patch.points.size());
  result.patch.points.insert(result.patch.points.end(), patch.points.begin(), patch.points.end());
  add_walls(patch, offset, result);
  add_bottom(patch, offset, result);
  return result;
}

}  // namespace dapple
