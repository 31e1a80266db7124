// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/thin_part.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <span>
#include <utility>

#include "base/hexagonal.hpp"
#include "base/sort_unique.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kNarrow = 3.2;       // spacings: largest circumference of a thin body
constexpr double kLong = 5.0;         // length relative to the circumference
constexpr double kWide = 0.02;        // share of the density in wider slabs, such as ends and knots
constexpr double kMostlyWide = 0.5;   // share of it in slabs as high as the spacing: not thin
constexpr double kFirstSlabs = 64.0;  // slabs to measure the total length of all branches
constexpr double kSlabs = 4.0;        // slabs per point
constexpr double kMostPieces = 0x1p24;  // most pieces of faces; with more, it is not tried
constexpr std::size_t kSpur = 8;        // most slabs of a dead end that is visited first
constexpr int kTries = 8;  // candidates in a slab; the one farthest from the last ones is taken
constexpr std::size_t kLast = 12;     // number of last positions
constexpr double kAround = 4.0;       // spacings within which darts are counted
constexpr double kCrowd = 40.0;       // fewer darts indicate a thin body: on a plane there are 58
constexpr std::size_t kCounted = 32;  // darts of a component whose neighbors are counted

/// The part of a triangle where a linear function is between two levels, in barycentric
/// coordinates.
struct Slice {
  double share = 0.0;  // share of the area
  Vec3 centroid = Vec3::Zero();
};

using Corners = std::vector<Vec3>;

/// A point of a face.
struct Place {
  OrderedFace face;
  Vec3 weights;  // barycentric
  Vec3 position;
};

/// Keep the part where sign * (value - level) >= 0.
Corners cut(const Corners& polygon, const Vec3& values, double level, double sign) {
  Corners result;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double at_a = sign * (a.dot(values) - level), at_b = sign * (b.dot(values) - level);
    if (at_a >= 0.0) result.push_back(a);
    if ((at_a < 0.0) != (at_b < 0.0)) result.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return result;
}

Slice slice(const Vec3& values, double low, double high) {
  if (values.minCoeff() >= low && values.maxCoeff() <= high)
    return {1.0, Vec3::Constant(1.0 / 3.0)};
  const Corners polygon =
      cut(cut({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, values, low, 1.0), values, high, -1.0);
  Slice result;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3 a = polygon[k - 1] - polygon[0], b = polygon[k] - polygon[0];
    const double part = std::abs(a.x() * b.y() - a.y() * b.x());  // share of the triangle's area
    result.share += part;
    result.centroid += part / 3.0 * (polygon[0] + polygon[k - 1] + polygon[k]);
  }
  if (result.share > 0.0) result.centroid /= result.share;
  return result;
}

/// A component divided into slabs by distance from one end. Each connected part of a slab is a
/// node: the nodes of a rope form a path, those of a net form a graph.
class Course {
 public:
  Course(const Surface& surface, std::span<const OrderedFace> faces)
      : surface_(surface.ordered()), faces_(faces) {
    for (const OrderedFace f : faces_)
      for (const std::int32_t v : surface_.welded_corners(f)) vertices_.push_back(v);
    sort_unique(vertices_);
    for (const OrderedFace f : faces_) {
      const Face corners = surface_.welded_corners(f);
      corners_.push_back({local(corners[0]), local(corners[1]), local(corners[2])});
    }
    join_vertices();
  }

  /// Positions that divide the density equally; none if the component is wide or short.
  std::optional<std::vector<Place>> places(std::size_t count, double phase, Random& random) {
    find_distances(random);
    if (!(length_ > 0.0) || !std::isfinite(length_)) return std::nullopt;
    // Most components are wide, and thinner slabs would cut each of their faces into many pieces.
    if (!divide(slabs_of_spacing(count)) || wide_share(count) > kMostlyWide) return std::nullopt;
    if (!divide(kFirstSlabs)) return std::nullopt;
    const double slabs = std::ceil(kSlabs * static_cast<double>(count) * length_ / along());
    if (!divide(slabs) || !is_thin(count)) return std::nullopt;
    visit();
    return take(count, phase, random);
  }

 private:
  struct Node {
    std::size_t slab = 0;
    double area = 0.0, capacity = 0.0;
    std::vector<std::size_t> pieces = {};  // pieces with density
    std::vector<std::size_t> beside = {};  // nodes in adjacent slabs
    bool visited = false;
  };
  struct Visit {
    std::size_t node;
    bool forward;
  };

  [[nodiscard]] std::size_t local(std::int32_t vertex) const {
    return static_cast<std::size_t>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) -
                                    vertices_.begin());
  }

  /// Compute the lengths of the edges between vertices.
  void join_vertices() {
    starts_.assign(vertices_.size() + 1, 0);
    for (const auto& corners : corners_)
      for (const std::size_t v : corners) starts_[v + 1] += 2;
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    edges_.resize(starts_.back());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t m = (k + 1) % 3;
        const double length = (corner(f, k) - corner(f, m)).norm();
        edges_[next[corners_[f][k]]++] = {length, corners_[f][m]};
        edges_[next[corners_[f][m]]++] = {length, corners_[f][k]};
      }
  }

  [[nodiscard]] const Vec3& corner(std::size_t face, std::size_t k) const {
    return surface_.vertex(surface_.corners(faces_[face])[k]);
  }

  /// Compute the distances from an end, which is the farthest vertex from some other vertex.
  void find_distances(Random& random) {
    const auto count = static_cast<double>(vertices_.size());
    measure_from(static_cast<std::size_t>(random.uniform() * count));
    measure_from(static_cast<std::size_t>(std::max_element(distances_.begin(), distances_.end()) -
                                          distances_.begin()));
    length_ = *std::max_element(distances_.begin(), distances_.end());
  }

  void measure_from(std::size_t start) {
    distances_.assign(vertices_.size(), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
    distances_[start] = 0.0;
    for (waiting.emplace(0.0, start); !waiting.empty();) {
      const auto [at, v] = waiting.top();
      waiting.pop();
      if (at > distances_[v]) continue;
      for (std::size_t e = starts_[v]; e < starts_[v + 1]; ++e) {
        const auto [length, to] = edges_[e];
        if (!(at + length < distances_[to])) continue;
        distances_[to] = at + length;
        waiting.emplace(at + length, to);
      }
    }
  }

  [[nodiscard]] Vec3 distances(std::size_t face) const {
    const auto& [a, b, c] = corners_[face];
    return {distances_[a], distances_[b], distances_[c]};
  }

  [[nodiscard]] std::size_t slab_at(double distance) const {
    return std::min(static_cast<std::size_t>(distance / height_), slabs_ - 1);
  }

  /// Divide the component into slabs. Returns false if there would be too many pieces.
  bool divide(double slabs) {
    if (!(slabs < kMostPieces)) return false;
    slabs_ = std::max<std::size_t>(1, static_cast<std::size_t>(slabs));
    height_ = length_ / static_cast<double>(slabs_);
    first_piece_.assign(1, 0);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const Vec3 at = distances(f);
      first_piece_.push_back(first_piece_.back() + slab_at(at.maxCoeff()) - slab_at(at.minCoeff()) +
                             1);
      if (static_cast<double>(first_piece_.back()) > kMostPieces) return false;
    }
    join_pieces();
    make_nodes();
    return true;
  }

  /// The piece of a face in a slab, if any.
  [[nodiscard]] std::optional<std::size_t> piece(std::size_t face, std::size_t slab) const {
    const std::size_t first = slab_at(distances(face).minCoeff());
    const std::size_t piece = first_piece_[face] + slab - first;
    if (slab < first || piece >= first_piece_[face + 1]) return std::nullopt;
    return piece;
  }

  /// Connects pieces in one slab on both sides of an edge.
  void join_pieces() {
    parents_.resize(first_piece_.back());
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = half_edge(faces_[f], k);
        for (std::int32_t g = surface_.next_around(h); g != h; g = surface_.next_around(g))
          if (g > h) join_over(f, static_cast<std::size_t>(k), face_index(face_of(g)));
      }
  }

  [[nodiscard]] std::size_t face_index(OrderedFace face) const {
    return static_cast<std::size_t>(std::lower_bound(faces_.begin(), faces_.end(), face) -
                                    faces_.begin());
  }

  void join_over(std::size_t face, std::size_t k, std::size_t other) {
    const auto [low, high] =
        std::minmax({distances_[corners_[face][k]], distances_[corners_[face][(k + 1) % 3]]});
    for (std::size_t slab = slab_at(low); slab <= slab_at(high); ++slab) {
      const auto a = piece(face, slab), b = piece(other, slab);
      if (a && b) parents_[root(*a)] = root(*b);
    }
  }

  std::size_t root(std::size_t piece) {
    while (parents_[piece] != piece) piece = parents_[piece] = parents_[parents_[piece]];
    return piece;
  }

  void make_nodes() {
    nodes_.clear();
    std::vector<std::size_t> node_at(parents_.size(), parents_.size());
    std::vector<std::size_t> node_of;
    faces_of_pieces_.clear();
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      std::size_t slab = slab_at(distances(f).minCoeff());
      for (std::size_t p = first_piece_[f]; p < first_piece_[f + 1]; ++p, ++slab) {
        std::size_t& node = node_at[root(p)];
        if (node == parents_.size()) {
          node = nodes_.size();
          nodes_.push_back({.slab = slab});
        }
        node_of.push_back(node);
        faces_of_pieces_.push_back(f);
        add_piece(f, p, nodes_[node]);
        if (p > first_piece_[f]) join_nodes(node_of[p - 1], node);
      }
    }
    for (Node& node : nodes_) {
      sort_unique(node.beside);
    }
  }

  void join_nodes(std::size_t a, std::size_t b) {
    nodes_[a].beside.push_back(b);
    nodes_[b].beside.push_back(a);
  }

  void add_piece(std::size_t face, std::size_t piece, Node& node) const {
    const double low = static_cast<double>(node.slab) * height_;
    const bool last = node.slab + 1 == slabs_;
    const Slice part = slice(distances(face), low, last ? 2.0 * length_ : low + height_);
    const double area = part.share * surface_.geometry(faces_[face]).moments.area;
    const double capacity = area * part.centroid.dot(surface_.densities(faces_[face]));
    node.area += area;
    node.capacity += capacity;
    if (capacity > 0.0) node.pieces.push_back(piece);
  }

  /// The number of slabs that are as high as the spacing.
  [[nodiscard]] double slabs_of_spacing(std::size_t count) const {
    return std::ceil(length_ / hexagonal_spacing(area() / static_cast<double>(count)));
  }

  /// The length of all branches, as far as slabs separate them.
  [[nodiscard]] double along() const { return height_ * static_cast<double>(nodes_.size()); }

  [[nodiscard]] double area() const {
    double sum = 0.0;
    for (const OrderedFace face : faces_) sum += surface_.geometry(face).moments.area;
    return sum;
  }

  /// The share of the density where the circumference is more than a few spacings.
  [[nodiscard]] double wide_share(std::size_t count) const {
    double all = 0.0, wide = 0.0;
    for (const Node& node : nodes_) all += node.capacity;
    const double share = all / static_cast<double>(count);
    for (const Node& node : nodes_)
      if (node.capacity > 0.0 &&
          node.area / height_ > kNarrow * hexagonal_spacing(share * node.area / node.capacity))
        wide += node.capacity;
    return all > 0.0 ? wide / all : 1.0;
  }

  /// Whether the component is long and its circumference almost everywhere at most a few spacings.
  [[nodiscard]] bool is_thin(std::size_t count) const {
    return wide_share(count) <= kWide && along() * along() >= kLong * area();
  }

  /// Visit all nodes, branch by branch.
  void visit() {
    order_.clear();
    std::vector<std::size_t> way;
    for (std::size_t first = 0; first < nodes_.size(); ++first)
      if (nodes_[first].slab == 0 && !nodes_[first].visited) go_to(first, true, way);
    while (!way.empty()) {
      const std::size_t at = way.back();
      if (const auto next = next_from(at))
        go_to(*next, nodes_[*next].slab > nodes_[at].slab, way);
      else
        way.pop_back();
    }
  }

  void go_to(std::size_t node, bool forward, std::vector<std::size_t>& way) {
    nodes_[node].visited = true;
    order_.push_back({node, forward});
    way.push_back(node);
  }

  /// Visits short dead ends first, because they would not be reached later.
  [[nodiscard]] std::optional<std::size_t> next_from(std::size_t at) const {
    std::vector<std::size_t> left;
    for (const std::size_t n : nodes_[at].beside)
      if (!nodes_[n].visited) left.push_back(n);
    if (left.empty()) return std::nullopt;
    if (left.size() > 1)
      for (const std::size_t n : left)
        if (is_spur(n)) return n;
    return left[0];
  }

  [[nodiscard]] bool is_spur(std::size_t node) const {
    std::vector<std::size_t> seen = {node};
    for (std::size_t k = 0; k < seen.size(); ++k)
      for (const std::size_t n : nodes_[seen[k]].beside) {
        if (nodes_[n].visited || std::find(seen.begin(), seen.end(), n) != seen.end()) continue;
        if (seen.size() == kSpur) return false;
        seen.push_back(n);
      }
    return true;
  }

  std::optional<std::vector<Place>> take(std::size_t count, double phase, Random& random) const {
    double all = 0.0;
    for (const Visit& visit : order_) all += nodes_[visit.node].capacity;
    std::vector<Place> result;
    double before = 0.0;
    for (const auto& [k, forward] : order_) {
      const Node& node = nodes_[k];
      while (result.size() < count) {
        const double wanted =
            (static_cast<double>(result.size()) + phase) / static_cast<double>(count) * all;
        if (!(wanted < before + node.capacity)) break;
        const double part = (wanted - before) / node.capacity;
        const auto place = place_in(node, forward ? part : 1.0 - part, result, random);
        if (!place) return std::nullopt;
        result.push_back(*place);
      }
      before += node.capacity;
    }
    if (result.size() != count) return std::nullopt;
    return result;
  }

  /// A position with density in a slab, at a share of its height. Of several candidates, the one
  /// farthest from the last positions is chosen.
  [[nodiscard]] std::optional<Place> place_in(const Node& node, double part,
                                              std::span<const Place> taken, Random& random) const {
    const double level = (static_cast<double>(node.slab) + part) * height_;
    const std::vector<std::size_t> faces = faces_at(node, level);
    taken = taken.last(std::min(taken.size(), kLast));
    std::optional<Place> best;
    double most = -1.0;
    for (int k = 0; k < kTries; ++k) {
      const auto n = static_cast<std::size_t>(random.uniform() * static_cast<double>(faces.size()));
      const Place place = place_on(faces[n], level, random.uniform());
      if (!(place.weights.dot(surface_.densities(place.face)) > 0.0)) continue;
      double room = std::numeric_limits<double>::max();
      for (const Place& other : taken)
        room = std::min(room, (other.position - place.position).squaredNorm());
      if (room > most) best = place;
      most = std::max(most, room);
    }
    return best;
  }

  /// The faces of a slab that reach the level; all of them if none does because of rounding.
  [[nodiscard]] std::vector<std::size_t> faces_at(const Node& node, double level) const {
    std::vector<std::size_t> all, there;
    for (const std::size_t p : node.pieces) {
      const std::size_t face = faces_of_pieces_[p];
      const Vec3 at = distances(face);
      all.push_back(face);
      if (at.minCoeff() < level && level < at.maxCoeff()) there.push_back(face);
    }
    return there.empty() ? all : there;
  }

  [[nodiscard]] Place place_on(std::size_t face, double level, double share) const {
    const Vec3 weights = at_level(distances(face), level, share);
    return {faces_[face], weights, surface_.point(faces_[face], weights)};
  }

  /// The point of a triangle at a share of the line where the distance is `level`.
  static Vec3 at_level(const Vec3& values, double level, double share) {
    std::array<Eigen::Index, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return values[a] != values[b] ? values[a] < values[b] : a < b;
    });
    const auto [low, middle, high] = order;
    const auto between = [&](Eigen::Index a, Eigen::Index b) {
      const double span = values[b] - values[a];
      const double part = span > 0.0 ? std::clamp((level - values[a]) / span, 0.0, 1.0) : 0.5;
      return Vec3((1.0 - part) * Vec3::Unit(a) + part * Vec3::Unit(b));
    };
    const Vec3 one = between(low, high);
    const Vec3 other = level < values[middle] ? between(low, middle) : between(middle, high);
    return (1.0 - share) * one + share * other;
  }

  const OrderedSurface& surface_;
  std::span<const OrderedFace> faces_;               // sorted
  std::vector<std::int32_t> vertices_;               // welded vertices, sorted
  std::vector<std::array<std::size_t, 3>> corners_;  // per face, as indices of vertices_
  std::vector<std::size_t> starts_;                  // rows of edges_
  std::vector<std::pair<double, std::size_t>> edges_;
  std::vector<double> distances_;  // per vertex, from one end
  double length_ = 0.0;            // the largest distance
  std::size_t slabs_ = 1;
  double height_ = 0.0;                   // of one slab
  std::vector<std::size_t> first_piece_;  // per face and one more: pieces by face, then by slab
  std::vector<std::size_t> parents_;  // per piece, parent link toward the first piece of its node
  std::vector<std::size_t> faces_of_pieces_;
  std::vector<Node> nodes_;
  std::vector<Visit> order_;
};

/// Whether the darts of a component have fewer darts around them than on a plane.
bool is_sparse(const std::vector<Dart*>& darts, double spacing) {
  const std::size_t step = (darts.size() + kCounted - 1) / kCounted;
  std::size_t around = 0, counted = 0;
  for (std::size_t k = 0; k < darts.size(); k += step, ++counted) {
    const double reach = kAround * spacing / std::sqrt(darts[k]->density);
    for (const Dart* dart : darts)
      if ((dart->position - darts[k]->position).squaredNorm() < reach * reach) ++around;
  }
  return static_cast<double>(around) < (kCrowd + 1.0) * static_cast<double>(counted);
}

/// The darts of each component that may be thin, except components with locked darts.
std::map<std::int32_t, std::vector<Dart*>> darts_of_thin(std::vector<Dart>& darts,
                                                         std::size_t locked, double spacing) {
  std::map<std::int32_t, std::vector<Dart*>> result;
  for (std::size_t k = locked; k < darts.size(); ++k)
    result[darts[k].component].push_back(&darts[k]);
  for (std::size_t k = 0; k < locked; ++k) result.erase(darts[k].component);
  std::erase_if(result, [&](const auto& part) { return !is_sparse(part.second, spacing); });
  return result;
}

}  // namespace

std::size_t lay_along_thin_parts(const Surface& surface, double spacing, std::size_t locked,
                                 double phase, Random& random, std::vector<Dart>& darts,
                                 const Context* context) {
  const auto thin = darts_of_thin(darts, locked, spacing);
  std::size_t moved = 0;
  if (thin.empty()) return moved;
  std::map<std::int32_t, std::vector<OrderedFace>> faces;
  for (const auto& [component, members] : thin) faces[component];
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const auto found = faces.find(surface.ordered().component(nth_face(f)));
    if (found != faces.end()) found->second.push_back(nth_face(f));
  }
  for (const auto& [component, members] : thin) {
    if (context) context->check();
    const auto places = Course(surface, faces[component]).places(members.size(), phase, random);
    if (!places) continue;
    const auto& found = *places;
    for (std::size_t k = 0; k < members.size(); ++k)
      *members[k] = dart_at(surface, found[k].face, found[k].weights);
    moved += members.size();
  }
  return moved;
}

}  // namespace dapple
