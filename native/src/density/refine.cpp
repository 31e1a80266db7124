// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/refine.hpp>
#include <numeric>
#include <tuple>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "density/pieces.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::int32_t kNone = -1;
// Shares of the progress: all cutting, and each round of the remaining cutting, because the number
// of rounds is unknown and the last ones take longest.
constexpr double kCut = 0.5;
constexpr double kRound = 0.25;

constexpr std::size_t kMoved = 4096;  // values between two checks

std::int32_t as_int(std::size_t k) { return static_cast<std::int32_t>(k); }

/// Reserve space for `count` values and move the existing ones in small portions, with checks for
/// cancellation. A vector that grows on its own would move gigabytes at once.
template <typename T>
void reserve_watched(std::vector<T>& values, std::size_t count, const Context* context) {
  if (count <= values.capacity()) return;
  std::vector<T> roomy;
  roomy.reserve(count);
  for (std::size_t k = 0; k < values.size(); k += kMoved) {
    check_context(context);
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(k);
    const std::size_t moved = std::min(kMoved, values.size() - k);
    roomy.insert(roomy.end(), first, first + static_cast<std::ptrdiff_t>(moved));
  }
  values = std::move(roomy);
}

struct Edge {
  std::array<std::int32_t, 2> ends;
  double squared_length;
  bool marked = false;
  std::int32_t midpoint = kNone;  // set when halved; the halves are then at `half` and `half + 1`
  std::int32_t half = kNone;
  std::int32_t twin;  // the next edge at the same place with other vertices, in a ring
};

struct Triangle {
  std::array<std::int32_t, 3> corners;
  std::array<std::int32_t, 3> edges;  // edge k runs from corner k to corner k + 1
  std::int32_t parent;
  std::array<Vec3, 3> barycentric;
  bool fresh = true;  // the criterion has not been evaluated for it
};

/// Triangles store their edges, and edges store their halves, so that neighbors use the same
/// midpoints, or midpoints at the same place if their vertices differ.
class CutMesh {
 public:
  CutMesh(const Surface& surface, const Context* context)
      : surface_(&surface),
        vertices_(surface.vertices()),
        faces_(surface.faces()),
        welded_(welded_vertices(surface)),
        context_(context) {
    std::vector<std::int32_t> edge_of(3 * faces_.size(), kNone);  // per half-edge
    triangles_.reserve(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      check_at(context_, f);
      if (!surface.ordered().counts(surface.ordered().ordered_face(as_int(f)))) continue;
      Triangle triangle{faces_[f], {}, as_int(f), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t h = half_edge(surface.ordered().ordered_face(as_int(f)), as_int(k));
        if (edge_of[static_cast<std::size_t>(h)] == kNone) number_ring(h, edge_of);
        triangle.edges[k] = edge_of[static_cast<std::size_t>(h)];
      }
      triangles_.push_back(triangle);
    }
  }

  /// Evaluate the criterion for new pieces. Returns whether an edge was marked.
  /// \param all whether pieces of faces without area are included
  bool mark(const Criterion& criterion, bool all) {
    std::vector<EdgeMarks> marks(triangles_.size(), EdgeMarks{});
    parallel_chunks(triangles_.size(), 256, [&](std::size_t begin, std::size_t end) {
      if (context_) context_->check();
      for (std::size_t t = begin; t < end; ++t)
        if (triangles_[t].fresh && (all || has_area(triangles_[t]))) marks[t] = criterion(piece(t));
    });
    bool any = false;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      check_at(context_, t);
      triangles_[t].fresh = false;
      for (std::size_t k = 0; k < 3; ++k)
        if (marks[t][k]) any = mark(triangles_[t].edges[k]);
    }
    return any;
  }

  /// Mark the longest edge of each triangle with a marked edge, until nothing changes.
  void close() {
    for (bool changed = true; changed;) {
      changed = false;
      for (const Triangle& triangle : triangles_) {
        check_at(context_, static_cast<std::size_t>(&triangle - triangles_.data()));
        if (marked_edges(triangle) == 0) continue;
        const std::int32_t longest = longest_of(triangle, [](const Edge&) { return true; });
        changed = changed || !edge(longest).marked;
        mark(longest);
      }
    }
  }

  [[nodiscard]] std::size_t size_after_cut() const {
    std::size_t size = triangles_.size();
    for (const Triangle& triangle : triangles_) {
      check_at(context_, static_cast<std::size_t>(&triangle - triangles_.data()));
      size += marked_edges(triangle);
    }
    return size;
  }

  /// Halve the marked edges and cut the triangles at them.
  /// \param size size_after_cut()
  void cut(std::size_t size) {
    std::vector<std::size_t> halved;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      check_at(context_, e);
      if (edges_[e].marked && edges_[e].midpoint == kNone) halved.push_back(e);
    }
    make_room(halved.size(), size - triangles_.size());
    for (std::size_t k = 0; k < halved.size(); ++k) {
      check_at(context_, k);
      halve(halved[k]);
    }
    for (std::size_t k = 0; k < halved.size(); ++k) {
      check_at(context_, k);
      link_halves(edges_[halved[k]]);
    }
    std::vector<Triangle> cut;
    cut.reserve(size);
    for (const Triangle& triangle : triangles_) {
      check_at(context_, static_cast<std::size_t>(&triangle - triangles_.data()));
      cut_at_longest(triangle, cut);
    }
    triangles_ = std::move(cut);
  }

  [[nodiscard]] Refined result(bool resolved, Context* context) &&;

 private:
  /// Reserve space for the halves of edges, and for an edge in each triangle that is cut.
  void make_room(std::size_t halved, std::size_t triangles) {
    reserve_watched(edges_, edges_.size() + 2 * halved + triangles, context_);
    reserve_watched(vertices_, vertices_.size() + halved, context_);
    reserve_watched(ends_, ends_.size() + halved, context_);
  }

  [[nodiscard]] Edge& edge(std::int32_t e) { return edges_[static_cast<std::size_t>(e)]; }
  [[nodiscard]] const Edge& edge(std::int32_t e) const {
    return edges_[static_cast<std::size_t>(e)];
  }
  [[nodiscard]] const Vec3& vertex(std::int32_t v) const {
    return vertices_[static_cast<std::size_t>(v)];
  }

  std::int32_t add_edge(std::int32_t a, std::int32_t b) {
    const std::int32_t e = as_int(edges_.size());
    edges_.push_back(
        {.ends = {a, b}, .squared_length = (vertex(b) - vertex(a)).squaredNorm(), .twin = e});
    return e;
  }

  /// Mark an edge and its twins, and thus for all faces.
  bool mark(std::int32_t e) {
    for (; !edge(e).marked; e = edge(e).twin) edge(e).marked = true;
    return true;
  }

  /// Number the edges of the half-edges at one place. There is one edge for each pair of vertices,
  /// and these edges are twins.
  void number_ring(std::int32_t half_edge, std::vector<std::int32_t>& edge_of) {
    const std::int32_t first = ends_of(half_edge)[0];
    std::vector<std::int32_t>& twins = ring_;
    twins.clear();
    std::int32_t h = half_edge;
    do {
      auto [a, b] = ends_of(h);
      if (welded_[static_cast<std::size_t>(a)] != welded_[static_cast<std::size_t>(first)])
        std::swap(a, b);
      edge_of[static_cast<std::size_t>(h)] = numbered(a, b, twins);
      h = surface_->ordered().next_around(h);
    } while (h != half_edge);
    for (std::size_t k = 0; k < twins.size(); ++k)
      edge(twins[k]).twin = twins[(k + 1) % twins.size()];
  }

  /// The edge between two vertices among the edges at one place; it is added if it is new.
  std::int32_t numbered(std::int32_t a, std::int32_t b, std::vector<std::int32_t>& twins) {
    const auto found = std::find_if(twins.begin(), twins.end(), [&](std::int32_t e) {
      return edge(e).ends == std::array{a, b};
    });
    if (found != twins.end()) return *found;
    twins.push_back(add_edge(a, b));
    return twins.back();
  }

  /// The caller's vertices where a half-edge starts and ends.
  [[nodiscard]] std::array<std::int32_t, 2> ends_of(std::int32_t half_edge) const {
    const Face& face =
        faces_[static_cast<std::size_t>(surface_->ordered().original_face(face_of(half_edge)))];
    const auto k = static_cast<std::size_t>(half_edge % 3);
    return {face[k], face[(k + 1) % 3]};
  }

  [[nodiscard]] bool has_area(const Triangle& triangle) const {
    return surface_->ordered()
               .geometry(surface_->ordered().ordered_face(triangle.parent))
               .moments.area > 0.0;
  }

  [[nodiscard]] Piece piece(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t].corners;
    return {triangles_[t].parent, triangles_[t].barycentric, {vertex(a), vertex(b), vertex(c)}};
  }

  [[nodiscard]] std::size_t marked_edges(const Triangle& triangle) const {
    return static_cast<std::size_t>(std::count_if(triangle.edges.begin(), triangle.edges.end(),
                                                  [&](std::int32_t e) { return edge(e).marked; }));
  }

  /// The longest of the edges that qualify, or kNone. Of equal edges the lowest number is chosen,
  /// so that all faces agree.
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
    edges_[e].midpoint = as_int(vertices_.size());
    edges_[e].half = as_int(edges_.size());
    ends_.push_back({a, b});
    vertices_.emplace_back(0.5 * (vertex(a) + vertex(b)));
    const std::int32_t middle = edges_[e].midpoint;
    add_edge(a, middle);
    add_edge(middle, b);
  }

  void link_halves(const Edge& e) {
    const std::int32_t other = edge(e.twin).half;
    edge(e.half).twin = other;
    edge(e.half + 1).twin = other + 1;
  }

  /// The half of the edge that touches `end`.
  [[nodiscard]] std::int32_t half_at(std::int32_t e, std::int32_t end) const {
    return edge(e).half + (edge(e).ends[0] == end ? 0 : 1);
  }

  // The recursion is at most three levels deep, because new edges are not halved in this round.
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

  /// Per half-edge, the lowest of the edges at its place.
  [[nodiscard]] std::vector<std::int32_t> joined_edges() const {
    std::vector<std::int32_t> result;
    result.reserve(3 * triangles_.size());
    for (const Triangle& triangle : triangles_) {
      check_at(context_, result.size(), std::size_t{3} * 4096);
      for (const std::int32_t e : triangle.edges) {
        std::int32_t lowest = e;
        for (std::int32_t t = edge(e).twin; t != e; t = edge(t).twin) lowest = std::min(lowest, t);
        result.push_back(lowest);
      }
    }
    return result;
  }

  /// Per vertex, the representative of all vertices at its place.
  [[nodiscard]] std::vector<std::int32_t> places() const {
    std::vector<std::int32_t> result(vertices_.size());
    std::iota(result.begin(), result.end(), 0);
    std::copy(welded_.begin(), welded_.end(), result.begin());
    for (const Edge& e : edges_) {
      check_at(context_, static_cast<std::size_t>(&e - edges_.data()));
      for (const Edge* t = &edge(e.twin); e.midpoint != kNone && t != &e; t = &edge(t->twin)) {
        std::int32_t& place = result[static_cast<std::size_t>(e.midpoint)];
        place = std::min(place, t->midpoint);
      }
    }
    return result;
  }

  const Surface* surface_;
  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;           // of the surface
  std::vector<std::int32_t> welded_;  // per vertex of the surface
  const Context* context_;
  std::vector<std::array<std::int32_t, 2>> ends_;
  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
  std::vector<std::int32_t> ring_;  // memory of number_ring()
};

Refined CutMesh::result(bool resolved, Context* context) && {
  std::vector<double> shares(ends_.size(), 0.5);
  Refined refined{*surface_, *surface_, {}, {}, std::move(ends_), std::move(shares), resolved};
  std::vector<Face> faces;
  faces.reserve(triangles_.size());
  refined.parents.reserve(triangles_.size());
  refined.barycentric.reserve(triangles_.size());
  for (const Triangle& triangle : triangles_) {
    check_at(context, faces.size());
    faces.push_back(triangle.corners);
    refined.parents.push_back(triangle.parent);
    refined.barycentric.push_back(triangle.barycentric);
  }
  const std::vector<double> density = carried_density(*surface_, refined, context);
  const std::vector<std::int32_t> bodies = carried_bodies(*surface_, refined.parents);
  refined.surface =
      Surface(vertices_, faces, Density{DensityAt::kCorners, density},
              Joints{joined_edges(), places(), bodies}, surface_->sharp_angle(),
              /*merge_doubled=*/false, context, carried_normals(*surface_, refined, context));
  return refined;
}

Refined cut(const Surface& surface, const Criterion& criterion, bool all, std::size_t max_faces,
            Context* context) {
  if (max_faces < 1 || max_faces > kMostRefinedFaces)
    throw ArgumentError("max_faces is " + std::to_string(max_faces) + ": it must be in 1.." +
                        std::to_string(kMostRefinedFaces));
  CutMesh mesh(surface, context);
  double done = 0.0;
  bool resolved = false, full = false;
  while (!resolved && !full) {
    if (context) context->check();
    resolved = !mesh.mark(criterion, all);
    mesh.close();
    const std::size_t size = mesh.size_after_cut();
    full = size > max_faces;
    if (!resolved && !full) mesh.cut(size);
    done += kRound * (kCut - done);
    if (context) context->advance(done);
  }
  if (context) context->advance(kCut);
  Stretch joining(context, kCut, 1.0);
  Refined refined = std::move(mesh).result(resolved, joining.context());
  if (context) context->advance(1.0);
  return refined;
}

}  // namespace

Refined refine(const Surface& surface, const Criterion& criterion, std::size_t max_faces,
               Context* context) {
  return cut(surface, criterion, false, max_faces, context);
}

Refined refine_edges(const Surface& surface, std::span<const double> longest, std::size_t max_faces,
                     Context* context) {
  if (longest.size() != 1)
    check_same_length("longest", longest.size(), "faces", surface.face_count());
  for (std::size_t k = 0; k < longest.size(); ++k)
    if (!(longest[k] > 0.0))
      throw ArgumentError(entry("longest", k) + " is " + number(longest[k]) + ": it must be > 0");
  const auto too_long = [&](const Piece& piece) {
    const double limit = longest[longest.size() == 1 ? 0 : static_cast<std::size_t>(piece.parent)];
    return longer_than(limit, piece.corners);
  };
  return cut(surface, too_long, true, max_faces, context);
}

}  // namespace dapple
