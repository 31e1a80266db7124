// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/density_support.hpp"

#include <algorithm>
#include <numeric>
#include <queue>

#include "base/hexagonal.hpp"
#include "base/parallel.hpp"

namespace dapple {
namespace {

// Spacings from density up to which faces count: sites on both sides of a gap twice as wide do not
// repel each other.
constexpr double kReach = 0.4;
// The largest of these spacings, relative to the mean: where density fades out it has no limit.
constexpr double kLargest = 2.0;

/// Where the vertices of FaceEdges are.
class Places {
 public:
  Places(const OrderedSurface& mesh, const FaceEdges& edges)
      : vertices_(mesh.vertices()), copied_(edges.copied()) {}
  [[nodiscard]] const Vec3& operator[](std::int32_t vertex) const {
    const std::size_t v = as_index(vertex);
    return vertices_[v < vertices_.size() ? v : as_index(copied_[v - vertices_.size()])];
  }

 private:
  std::span<const Vec3> vertices_;
  std::span<const std::int32_t> copied_;
};

/// The vertices that are one where edges are connected: at a welded seam each is several.
Sets joined_vertices(const OrderedSurface& mesh, const FaceEdges& edges) {
  Sets joined(edges.vertex_count());
  const auto next = [](std::int32_t h) { return half_edge(face_of(h), (h + 1) % 3); };
  const auto corner = [&](std::int32_t h) {
    return edges.corners()[as_index(face_of(h))][as_index(h % 3)];
  };
  const auto welded = [&](std::int32_t h) {
    return mesh.welded_corners(face_of(h))[as_index(h % 3)];
  };
  const auto join_if_one = [&](std::int32_t h, std::int32_t g) {
    if (corner(h) != corner(g) && welded(h) == welded(g)) joined.join(corner(h), corner(g));
  };
  const auto count = static_cast<std::int32_t>(3 * mesh.face_count());
  for (std::int32_t h = 0; h < count; ++h)
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) {
      if (g < h) continue;
      for (const std::int32_t end : {h, next(h)}) {
        join_if_one(end, g);
        join_if_one(end, next(g));
      }
    }
  return joined;
}

/// The faces without density by vertex, in rows.
class FacesByVertex {
 public:
  FacesByVertex(const FaceEdges& edges, Sets& joined, std::span<const char> dense)
      : first_(edges.vertex_count() + 1, 0) {
    const auto for_each_corner = [&](const auto& visit) {
      for (std::size_t f = 0; f < dense.size(); ++f)
        if (dense[f] == 0)
          for (const std::int32_t v : edges.corners()[f]) visit(f, as_index(joined.find(v)));
    };
    for_each_corner([&](std::size_t, std::size_t v) { ++first_[v + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    faces_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_each_corner([&](std::size_t f, std::size_t v) { faces_[next[v]++] = nth_face(f); });
  }

  [[nodiscard]] std::span<const OrderedFace> at(std::int32_t vertex) const {
    const auto v = as_index(vertex);
    return std::span(faces_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<OrderedFace> faces_;
};

/// Spreads from density over faces without, along edges, as far as given at each vertex (Dijkstra).
class Spread {
 public:
  Spread(const OrderedSurface& mesh, const FaceEdges& edges, Sets& joined,
         std::span<const char> dense)
      : edges_(edges),
        joined_(joined),
        at_(mesh, edges),
        gaps_(edges, joined, dense),
        left_(edges.vertex_count(), -1.0) {}

  [[nodiscard]] bool is_beside_gap(std::int32_t vertex) const {
    return !gaps_.at(joined_.find(vertex)).empty();
  }

  void reach(std::int32_t corner, double left) {
    const std::int32_t vertex = joined_.find(corner);
    if (left < 0.0 || !(left > left_[as_index(vertex)])) return;
    left_[as_index(vertex)] = left;
    queue_.emplace(left, vertex);
  }

  template <typename Visit>
  void run(const Visit& visit) {
    while (!queue_.empty()) {
      const auto [left, v] = queue_.top();
      queue_.pop();
      if (left < left_[as_index(v)]) continue;
      for (const OrderedFace face : gaps_.at(v)) {
        visit(face);
        for (const std::int32_t u : edges_.corners()[as_index(face)])
          reach(u, left - (at_[u] - at_[v]).norm());
      }
    }
  }

 private:
  const FaceEdges& edges_;
  Sets& joined_;
  Places at_;
  FacesByVertex gaps_;
  std::vector<double> left_;  // per vertex; below 0: not reached
  std::priority_queue<std::pair<double, std::int32_t>> queue_;
};

}  // namespace

DensitySupport::DensitySupport(const Surface& surface, const FaceEdges& edges, std::size_t count)
    : faces_(surface.face_count(), 0) {
  Sets joined = joined_vertices(surface.ordered(), edges);
  add_faces_near_density(surface, edges, joined, count);
  face_count_ = static_cast<std::size_t>(std::count(faces_.begin(), faces_.end(), 1));
  number_parts(edges, std::move(joined));
  find_edges(edges);
  find_pinched(surface.ordered(), edges);
}

void DensitySupport::add_faces_near_density(const Surface& surface, const FaceEdges& edges,
                                            Sets& joined, std::size_t count) {
  const OrderedSurface& mesh = surface.ordered();
  double area = 0.0, capacity = 0.0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Moments& own = mesh.geometry(nth_face(f)).moments;
    if (!(own.capacity > 0.0)) continue;
    faces_[f] = 1;
    area += own.area;
    capacity += own.capacity;
  }
  const double each = 1.0 / static_cast<double>(std::max<std::size_t>(count, 1));
  const double largest = kLargest * hexagonal_spacing(each * area);
  Spread spread(mesh, edges, joined, faces_);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f] == 0) continue;
    const Moments& own = mesh.geometry(nth_face(f)).moments;
    for (const std::int32_t v : edges.corners()[f])
      if (spread.is_beside_gap(v)) {
        const double spacing = hexagonal_spacing(each * capacity * own.area / own.capacity);
        spread.reach(v, kReach * std::min(spacing, largest));
      }
  }
  spread.run([&](OrderedFace face) { faces_[as_index(face)] = 1; });
}

void DensitySupport::number_parts(const FaceEdges& edges, Sets sets) {
  parts_.assign(edges.vertex_count(), -1);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f] == 0) continue;
    const auto [a, b, c] = edges.corners()[f];
    sets.join(a, b);
    sets.join(b, c);
    for (const std::int32_t v : {a, b, c}) parts_[as_index(v)] = 0;
  }
  std::vector<std::int32_t> numbers(parts_.size(), -1);  // by the lowest vertex
  for (std::size_t v = 0; v < parts_.size(); ++v) {
    if (parts_[v] < 0) continue;
    std::int32_t& number = numbers[as_index(sets.find(static_cast<std::int32_t>(v)))];
    if (number < 0) number = static_cast<std::int32_t>(part_count_++);
    parts_[v] = number;
  }
}

void DensitySupport::find_edges(const FaceEdges& edges) {
  edges_.assign(edges.first_edge(edges.chunks()), 0);
  parallel_chunks(faces_.size(), FaceEdges::kFaces, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = edges.first_edge(begin / FaceEdges::kFaces);
    for (std::size_t f = begin; f < end; ++f)
      if (faces_[f] != 0)
        for (const std::uint16_t edge : edges.of(nth_face(f)).edges) edges_[first + edge] = 1;
  });
}

void DensitySupport::find_pinched(const OrderedSurface& mesh, const FaceEdges& edges) {
  const auto ends_here = [&](std::int32_t h) {
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g))
      if (has(face_of(g))) return false;
    return true;
  };
  std::vector<char> fans(edges.vertex_count(), 0);  // those that end at an edge; two are enough
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f] == 0) continue;
    for (std::int32_t k = 0; k < 3; ++k) {
      if (!ends_here(half_edge(nth_face(f), (k + 2) % 3))) continue;
      const std::int32_t v = edges.corners()[f][static_cast<std::size_t>(k)];
      if (++fans[as_index(v)] == 2) pinched_.push_back(v);
      fans[as_index(v)] = std::min<char>(fans[as_index(v)], 2);
    }
  }
}

}  // namespace dapple
