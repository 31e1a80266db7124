// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/refine.hpp>
#include <tuple>

#include "parallel.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

constexpr std::int32_t kNone = -1;
constexpr std::size_t kMostFaces = 200'000'000;  // their corners and edges must fit into 32 bits

std::int32_t as_index(std::size_t k) { return static_cast<std::int32_t>(k); }

struct Edge {
  std::array<std::int32_t, 2> ends;
  double squared_length;
  bool marked = false;
  std::int32_t midpoint = kNone;  // once halved, with its halves at `half` and `half + 1`
  std::int32_t half = kNone;
};

struct Triangle {
  std::array<std::int32_t, 3> corners;
  std::array<std::int32_t, 3> edges;  // k: from corner k to corner k + 1
  std::int32_t parent;
  std::array<Vec3, 3> barycentric;
  bool fresh = true;  // the criterion has not seen it
};

/// Triangles that know their edges, and edges their halves: neighbours find the same midpoints.
class CutMesh {
 public:
  explicit CutMesh(const Surface& surface) : surface_(&surface), vertices_(surface.vertices()) {
    const std::vector<Face> faces = surface.faces();
    std::vector<std::int32_t> edge_of(3 * faces.size(), kNone);  // per half-edge
    for (std::size_t f = 0; f < faces.size(); ++f) {
      Triangle triangle{faces[f], {}, as_index(f), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t h = 3 * surface.ordered_face(as_index(f)) + as_index(k);
        if (edge_of[static_cast<std::size_t>(h)] == kNone)
          number_ring(h, add_edge(faces[f][k], faces[f][(k + 1) % 3]), edge_of);
        triangle.edges[k] = edge_of[static_cast<std::size_t>(h)];
      }
      triangles_.push_back(triangle);
    }
  }

  /// Ask about the pieces not yet seen; true if an edge is marked.
  bool mark(const Criterion& criterion) {
    std::vector<EdgeMarks> marks(triangles_.size(), EdgeMarks{});
    parallel_chunks(triangles_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        if (triangles_[t].fresh && has_area(triangles_[t])) marks[t] = criterion(piece(t));
    });
    bool any = false;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      triangles_[t].fresh = false;
      for (std::size_t k = 0; k < 3; ++k)
        if (marks[t][k]) any = edge(triangles_[t].edges[k]).marked = true;
    }
    return any;
  }

  /// With an edge of a triangle mark its longest, until that holds everywhere.
  void close() {
    for (bool changed = true; changed;) {
      changed = false;
      for (const Triangle& triangle : triangles_) {
        if (marked_edges(triangle) == 0) continue;
        Edge& longest = edge(longest_of(triangle, [](const Edge&) { return true; }));
        changed = changed || !longest.marked;
        longest.marked = true;
      }
    }
  }

  [[nodiscard]] std::size_t size_after_cut() const {
    std::size_t size = triangles_.size();
    for (const Triangle& triangle : triangles_) size += marked_edges(triangle);
    return size;
  }

  /// Halve the marked edges and cut the triangles at them.
  void cut() {
    const std::size_t count = edges_.size();
    for (std::size_t e = 0; e < count; ++e)
      if (edges_[e].marked) halve(e);
    std::vector<Triangle> cut;
    cut.reserve(2 * triangles_.size());
    for (const Triangle& triangle : triangles_) cut_at_longest(triangle, cut);
    triangles_ = std::move(cut);
  }

  [[nodiscard]] Refined result(bool resolved) &&;

 private:
  [[nodiscard]] Edge& edge(std::int32_t e) { return edges_[static_cast<std::size_t>(e)]; }
  [[nodiscard]] const Edge& edge(std::int32_t e) const {
    return edges_[static_cast<std::size_t>(e)];
  }
  [[nodiscard]] const Vec3& vertex(std::int32_t v) const {
    return vertices_[static_cast<std::size_t>(v)];
  }

  std::int32_t add_edge(std::int32_t a, std::int32_t b) {
    edges_.push_back({{a, b}, (vertex(b) - vertex(a)).squaredNorm()});
    return as_index(edges_.size() - 1);
  }

  void number_ring(std::int32_t half_edge, std::int32_t number,
                   std::vector<std::int32_t>& edge_of) const {
    std::int32_t h = half_edge;
    do {
      edge_of[static_cast<std::size_t>(h)] = number;
      h = surface_->next_around(h);
    } while (h != half_edge);
  }

  [[nodiscard]] bool has_area(const Triangle& triangle) const {
    return surface_->geometry(surface_->ordered_face(triangle.parent)).moments.area > 0.0;
  }

  [[nodiscard]] Piece piece(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t].corners;
    return {triangles_[t].parent, triangles_[t].barycentric, {vertex(a), vertex(b), vertex(c)}};
  }

  [[nodiscard]] std::size_t marked_edges(const Triangle& triangle) const {
    return static_cast<std::size_t>(std::count_if(triangle.edges.begin(), triangle.edges.end(),
                                                  [&](std::int32_t e) { return edge(e).marked; }));
  }

  /// The longest of the edges that qualify, or kNone; the lower number at ties, on all sides alike.
  template <typename Qualifies>
  [[nodiscard]] std::int32_t longest_of(const Triangle& triangle,
                                        const Qualifies& qualifies) const {
    std::int32_t best = kNone;
    const auto key = [&](std::int32_t e) { return std::tuple(edge(e).squared_length, -e); };
    for (const std::int32_t e : triangle.edges)
      if (qualifies(edge(e)) && (best == kNone || key(e) > key(best))) best = e;
    return best;
  }

  void halve(std::size_t e) {
    const auto [a, b] = edges_[e].ends;
    edges_[e].midpoint = as_index(vertices_.size());
    edges_[e].half = as_index(edges_.size());
    ends_.push_back({a, b});
    vertices_.emplace_back(0.5 * (vertex(a) + vertex(b)));
    const std::int32_t middle = edges_[e].midpoint;
    add_edge(a, middle);
    add_edge(middle, b);
  }

  /// The half of the edge that touches `end`.
  [[nodiscard]] std::int32_t half_at(std::int32_t e, std::int32_t end) const {
    return edge(e).half + (edge(e).ends[0] == end ? 0 : 1);
  }

  // At most three deep: the new edges are not halved in this round.
  void cut_at_longest(const Triangle& triangle, std::vector<Triangle>& out) {
    const std::int32_t e =
        longest_of(triangle, [](const Edge& candidate) { return candidate.midpoint != kNone; });
    if (e == kNone) {
      out.push_back(triangle);
      return;
    }
    const auto k = static_cast<std::size_t>(
        std::find(triangle.edges.begin(), triangle.edges.end(), e) - triangle.edges.begin());
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const std::int32_t p = triangle.corners[k], q = triangle.corners[next];
    const std::int32_t r = triangle.corners[last], middle = edge(e).midpoint;
    const std::int32_t inner = add_edge(middle, r);
    const Vec3 weights = 0.5 * (triangle.barycentric[k] + triangle.barycentric[next]);
    cut_at_longest({{p, middle, r},
                    {half_at(e, p), inner, triangle.edges[last]},
                    triangle.parent,
                    {triangle.barycentric[k], weights, triangle.barycentric[last]}},
                   out);
    cut_at_longest({{middle, q, r},
                    {half_at(e, q), triangle.edges[next], inner},
                    triangle.parent,
                    {weights, triangle.barycentric[next], triangle.barycentric[last]}},
                   out);
  }

  const Surface* surface_;
  std::vector<Vec3> vertices_;
  std::vector<std::array<std::int32_t, 2>> ends_;
  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
};

/// The density of the surface at the corners of pieces of its faces.
std::vector<double> carried_density(const Surface& surface, const Refined& refined) {
  std::vector<double> values;
  if (surface.uniform()) return values;
  values.reserve(3 * refined.parents.size());
  for (std::size_t f = 0; f < refined.parents.size(); ++f)
    for (const Vec3& weights : refined.barycentric[f])
      values.push_back(weights.dot(surface.densities(surface.ordered_face(refined.parents[f]))));
  return values;
}

Refined CutMesh::result(bool resolved) && {
  Refined refined{*surface_, *surface_, {}, {}, std::move(ends_), resolved};
  std::vector<Face> faces;
  for (const Triangle& triangle : triangles_) {
    faces.push_back(triangle.corners);
    refined.parents.push_back(triangle.parent);
    refined.barycentric.push_back(triangle.barycentric);
  }
  const std::vector<double> density = carried_density(*surface_, refined);
  refined.surface = Surface(vertices_, faces, Density{DensityAt::kCorners, density});
  return refined;
}

}  // namespace

Refined refine(const Surface& surface, const Criterion& criterion, std::size_t max_faces,
               const Context* context) {
  if (max_faces < 1 || max_faces > kMostFaces)
    throw ArgumentError("max_faces is " + std::to_string(max_faces) + ": it must be in 1.." +
                        std::to_string(kMostFaces));
  CutMesh mesh(surface);
  while (true) {
    if (context) context->check();
    if (!mesh.mark(criterion)) return std::move(mesh).result(true);
    mesh.close();
    if (mesh.size_after_cut() > max_faces) return std::move(mesh).result(false);
    mesh.cut();
  }
}

Refined refine_edges(const Surface& surface, std::span<const double> longest, std::size_t max_faces,
                     const Context* context) {
  if (longest.size() != 1)
    check_same_length("longest", longest.size(), "faces", surface.face_count());
  for (std::size_t k = 0; k < longest.size(); ++k)
    if (!(longest[k] > 0.0))
      throw ArgumentError(entry("longest", k) + " is " + number(longest[k]) + ": it must be > 0");
  const auto too_long = [&](const Piece& piece) {
    const double limit = longest[longest.size() == 1 ? 0 : static_cast<std::size_t>(piece.parent)];
    EdgeMarks marks{};
    for (std::size_t k = 0; k < 3; ++k)
      marks[k] = (piece.corners[(k + 1) % 3] - piece.corners[k]).norm() > limit;
    return marks;
  };
  return refine(surface, too_long, max_faces, context);
}

}  // namespace dapple
