// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/feature_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <unordered_map>

#include "base/progress.hpp"
#include "base/sets.hpp"
#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kNeedle = 0.02;  // of its longest edge, and of the scale: the height of a needle
constexpr int kMostNeedles = 8;   // side by side
// Creases of scans are many short ones, which end in the middle of smooth parts.
constexpr double kLeast = 6.0;     // scales: length of creases that meet, in total
constexpr double kLeastEnd = 4.0;  // scales: length of a crease that ends nowhere
constexpr double kFlat = 0.95;     // folds of rough parts are no creases
constexpr double kRound = 6.0;  // points of a closed line without corners, if it has so many edges
constexpr double kFacet = 0.6;  // of the scale: parts between creases that reach less are noise

std::int32_t start_of(const OrderedSurface& mesh, std::int32_t h) {
  return mesh.welded_corners(face_of(h))[static_cast<std::size_t>(h % 3)];
}

std::int32_t end_of(const OrderedSurface& mesh, std::int32_t h) {
  return mesh.welded_corners(face_of(h))[static_cast<std::size_t>((h + 1) % 3)];
}

Vec3 place_of(const OrderedSurface& mesh, std::int32_t vertex) { return mesh.vertex(vertex); }

int faces_around(const OrderedSurface& mesh, std::int32_t h) {
  int count = 1;
  for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) ++count;
  return count;
}

/// The only other half-edge of an edge with two faces; -1 where there is none, or several.
std::int32_t twin_of(const OrderedSurface& mesh, std::int32_t h) {
  const std::int32_t g = mesh.next_around(h);
  return g != h && mesh.next_around(g) == h ? g : -1;
}

/// Whether a face is so narrow that its normal means nothing, and which is its longest edge.
bool is_needle(const OrderedSurface& mesh, OrderedFace face, double scale, std::int32_t& longest) {
  double most = 0.0;
  for (std::int32_t c = 0; c < 3; ++c) {
    const std::int32_t h = half_edge(face, c);
    const double length =
        (place_of(mesh, end_of(mesh, h)) - place_of(mesh, start_of(mesh, h))).norm();
    if (length > most) longest = h;
    most = std::max(most, length);
  }
  const double height = most > 0.0 ? 2.0 * mesh.geometry(face).moments.area / most : 0.0;
  return height <= kNeedle * std::min(most, scale);
}

/// The half-edge of the face that lies on the side of `h`, beyond needles. A crease along a needle
/// is on its longest edge alone: -1 at the others.
std::int32_t beside_needles(const OrderedSurface& mesh, std::int32_t h, double scale) {
  for (int steps = 0; steps < kMostNeedles; ++steps) {
    std::int32_t longest = h;
    if (!is_needle(mesh, face_of(h), scale, longest)) return h;
    if (longest != h) return -1;
    std::int32_t next = -1;
    double most = -1.0;
    for (std::int32_t c = 0; c < 3; ++c) {
      const std::int32_t other = half_edge(face_of(h), c);
      const double length =
          (place_of(mesh, end_of(mesh, other)) - place_of(mesh, start_of(mesh, other))).norm();
      if (other == h || length <= most) continue;
      most = length;
      next = twin_of(mesh, other);
    }
    if (next < 0) return -1;
    h = next;
    std::int32_t beyond = h;
    if (is_needle(mesh, face_of(h), scale, beyond) && beyond != h) return -1;
  }
  return -1;
}

/// An edge of a line, between welded vertices.
struct LineEdge {
  std::int32_t half_edge, from, to;
  double length;
};

std::vector<LineEdge> line_edges(const OrderedSurface& mesh, std::span<const LineKind> kinds) {
  std::vector<LineEdge> result;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    if (kinds[k] == LineKind::kNone || edge_of(mesh, h) != h) continue;
    const std::int32_t a = start_of(mesh, h), b = end_of(mesh, h);
    if (a == b) continue;
    result.push_back({h, a, b, (place_of(mesh, b) - place_of(mesh, a)).norm()});
  }
  return result;
}

/// The lines' edges at each vertex.
class Network {
 public:
  explicit Network(std::vector<LineEdge> edges) : edges_(std::move(edges)) {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      at_.push_back({edges_[e].from, static_cast<std::int32_t>(e)});
      at_.push_back({edges_[e].to, static_cast<std::int32_t>(e)});
    }
    std::ranges::sort(at_);
  }

  [[nodiscard]] const std::vector<LineEdge>& edges() const { return edges_; }
  [[nodiscard]] const LineEdge& edge(std::int32_t e) const { return edges_[as_index(e)]; }

  using Entry = std::array<std::int32_t, 2>;  // vertex, edge
  [[nodiscard]] std::span<const Entry> at(std::int32_t vertex) const {
    const auto first = std::ranges::lower_bound(at_, Entry{vertex, -1});
    const auto last = std::ranges::lower_bound(at_, Entry{vertex + 1, -1});
    return {first, last};
  }
  [[nodiscard]] std::vector<std::int32_t> vertices() const {
    std::vector<std::int32_t> result;
    for (const Entry& entry : at_)
      if (result.empty() || result.back() != entry[0]) result.push_back(entry[0]);
    return result;
  }
  [[nodiscard]] std::int32_t other_end(std::int32_t e, std::int32_t vertex) const {
    return edge(e).from == vertex ? edge(e).to : edge(e).from;
  }
  /// The edge after `e` at a vertex of two edges; -1 elsewhere.
  [[nodiscard]] std::int32_t after(std::int32_t e, std::int32_t vertex) const {
    const auto around = at(vertex);
    if (around.size() != 2) return -1;
    return around[0][1] == e ? around[1][1] : around[0][1];
  }

  /// The place on the line at a distance from a vertex, in the direction of an edge.
  [[nodiscard]] Vec3 ahead(const OrderedSurface& mesh, std::int32_t vertex, std::int32_t e,
                           double distance) const {
    const std::int32_t first = e;
    while (true) {
      const std::int32_t next = other_end(e, vertex);
      const Vec3 from = place_of(mesh, vertex), to = place_of(mesh, next);
      if (distance <= edge(e).length && edge(e).length > 0.0)
        return from + distance / edge(e).length * (to - from);
      distance -= edge(e).length;
      const std::int32_t following = after(e, next);
      if (following < 0 || following == first) return to;
      vertex = next;
      e = following;
    }
  }

  /// Cosine of the turn of the line at a vertex of two edges.
  [[nodiscard]] double turn(const OrderedSurface& mesh, std::int32_t vertex, double scale) const {
    const auto around = at(vertex);
    const Vec3 here = place_of(mesh, vertex);
    const Vec3 before = here - ahead(mesh, vertex, around[0][1], scale);
    const Vec3 behind = ahead(mesh, vertex, around[1][1], scale) - here;
    const double lengths = before.norm() * behind.norm();
    return lengths > 0.0 ? before.dot(behind) / lengths : 1.0;
  }

 private:
  std::vector<LineEdge> edges_;
  std::vector<Entry> at_;
};

/// Of the corners along a line that turns over several edges, only the sharpest within the scale
/// stays.
void keep_sharpest(const OrderedSurface& mesh, double scale,
                   std::vector<std::pair<double, std::int32_t>>& turns) {
  std::ranges::sort(turns);
  std::vector<std::pair<double, std::int32_t>> kept;
  for (const auto& turn : turns) {
    const Vec3 here = place_of(mesh, turn.second);
    if (std::ranges::none_of(kept, [&](const auto& other) {
          return (place_of(mesh, other.second) - here).norm() < scale;
        }))
      kept.push_back(turn);
  }
  turns = std::move(kept);
}

/// Mean normals of the surface on one side of an edge, up to the next lines.
class SideNormals {
 public:
  SideNormals(const OrderedSurface& mesh, const FeatureLines& lines, double reach)
      : mesh_(mesh), lines_(lines), reach_(reach), stamps_(mesh.face_count(), -1) {}

  [[nodiscard]] Vec3 beside(std::int32_t h) {
    const Vec3 middle =
        0.5 * (place_of(mesh_, start_of(mesh_, h)) + place_of(mesh_, end_of(mesh_, h)));
    ++stamp_;
    reached_.assign(1, face_of(h));
    stamps_[as_index(face_of(h))] = stamp_;
    Vec3 sum = Vec3::Zero();
    extent_ = 0.0;
    double total = 0.0;
    for (std::size_t k = 0; k < reached_.size() && k < kMostFaces; ++k) {
      for (const std::int32_t v : mesh_.corners(reached_[k]))
        extent_ = std::max(extent_, (mesh_.vertex(v) - middle).norm());
      const FaceGeometry& geometry = mesh_.geometry(reached_[k]);
      sum += lines_.sign(reached_[k]) * geometry.moments.area * geometry.normal;
      total += geometry.moments.area;
      for (std::int32_t c = 0; c < 3; ++c) cross(half_edge(reached_[k], c), middle);
    }
    flatness_ = total > 0.0 ? sum.norm() / total : 0.0;
    return sum.normalized();
  }
  /// How alike the normals of those faces are: 1 in a plane.
  [[nodiscard]] double flatness() const { return flatness_; }
  /// How far the faces reach that made the last normal.
  [[nodiscard]] double extent() const { return extent_; }

 private:
  static constexpr std::size_t kMostFaces = 256;

  void cross(std::int32_t h, const Vec3& middle) {
    if (lines_.is_line(h)) return;
    const OrderedFace next = face_of(mesh_.next_around(h));
    if (stamps_[as_index(next)] == stamp_) return;
    stamps_[as_index(next)] = stamp_;
    if ((mesh_.geometry(next).centroid - middle).norm() <= reach_) reached_.push_back(next);
  }

  const OrderedSurface& mesh_;
  const FeatureLines& lines_;
  double reach_;
  std::vector<std::int32_t> stamps_;
  std::int32_t stamp_ = -1;
  double extent_ = 0.0, flatness_ = 0.0;
  std::vector<OrderedFace> reached_;
};

double density_root(const OrderedSurface& mesh, std::int32_t h, bool end) {
  const Vec3 values = mesh.densities(face_of(h));
  return std::sqrt(std::max(values[(h + (end ? 1 : 0)) % 3], 0.0));
}

/// Length of an edge of a chain in local units.
double metric(const OrderedSurface& mesh, std::int32_t h) {
  const Vec3 along = place_of(mesh, end_of(mesh, h)) - place_of(mesh, start_of(mesh, h));
  return 0.5 * (density_root(mesh, h, false) + density_root(mesh, h, true)) * along.norm();
}

void append_point(Sites& sites, const Sites& point) {
  sites.positions.push_back(point.positions[0]);
  sites.faces.push_back(point.faces[0]);
  sites.barycentric.push_back(point.barycentric[0]);
}

/// Per chain the fewest parts that make a mesh of it: closed ones become triangles at least, and no
/// two chains between the same corners are one edge each.
std::vector<double> fewest_parts(std::span<const LineChain> chains) {
  std::vector<double> result;
  std::map<std::pair<std::int32_t, std::int32_t>, int> between;
  const auto ends = [](const LineChain& chain) {
    const std::int32_t a = chain.vertices.front(), b = chain.vertices.back();
    return std::pair(std::min(a, b), std::max(a, b));
  };
  for (const LineChain& chain : chains) ++between[ends(chain)];
  for (const LineChain& chain : chains) {
    const auto [a, b] = ends(chain);
    const double round = chain.closed ? kRound : 3.0;
    result.push_back(a == b ? std::clamp(static_cast<double>(chain.half_edges.size()), 3.0, round)
                     : between[{a, b}] > 1 ? 2.0
                                           : 1.0);
  }
  return result;
}

void place_along(const OrderedSurface& mesh, const LineChain& chain, double unit, double fewest,
                 std::int32_t number, LineSites& result) {
  std::vector<double> ends;
  double total = 0.0;
  for (const std::int32_t h : chain.half_edges) ends.push_back(total += metric(mesh, h));
  const double parts = std::max(std::round(total / unit), fewest);
  if (!(total > 0.0)) return;
  std::size_t e = 0;
  for (double k = chain.closed ? 0.0 : 1.0; k < parts; ++k) {
    const double at = total * k / parts;
    while (e + 1 < ends.size() && ends[e] < at) ++e;
    const double from = e == 0 ? 0.0 : ends[e - 1];
    const double share =
        ends[e] > from ? std::clamp((at - from) / (ends[e] - from), 0.0, 1.0) : 0.0;
    const std::int32_t h = chain.half_edges[e];
    const bool along = start_of(mesh, h) == chain.vertices[e];
    append_point(result.sites, point_on_edge(mesh, h, along ? share : 1.0 - share));
    result.chains.push_back(number);
  }
}

}  // namespace

std::int32_t edge_of(const OrderedSurface& mesh, std::int32_t half_edge) {
  std::int32_t lowest = half_edge;
  for (std::int32_t g = mesh.next_around(half_edge); g != half_edge; g = mesh.next_around(g))
    lowest = std::min(lowest, g);
  return lowest;
}

FeatureLines::FeatureLines(const Surface& surface, const LineRules& rules, const Context* context)
    : kinds_(3 * surface.face_count(), LineKind::kNone), signs_(surface.face_count(), 0) {
  const OrderedSurface& mesh = surface.ordered();
  orient(mesh, context);
  classify(mesh, rules, context);
  mark(mesh, rules.marked);
  find_pinched(mesh);
  drop_noise(mesh, rules);
  while (drop_small(mesh, rules.scale)) check_context(context);
  build(mesh, rules);
}

FeatureLines::FeatureLines(const Refined& fine, const FeatureLines& coarse, const LineRules& rules)
    : kinds_(3 * fine.surface.face_count(), LineKind::kNone), signs_(fine.surface.face_count(), 0) {
  const OrderedSurface &mesh = fine.surface.ordered(), &whole = fine.original.ordered();
  for (std::size_t f = 0; f < signs_.size(); ++f) {
    const OrderedFace face = mesh.ordered_face(static_cast<std::int32_t>(f));
    const OrderedFace parent = whole.ordered_face(fine.parents[f]);
    signs_[as_index(face)] = static_cast<std::int8_t>(coarse.sign(parent));
    if (!mesh.counts(face)) continue;
    for (std::int32_t c = 0; c < 3; ++c)
      for (std::int32_t k = 0; k < 3; ++k) {
        const auto beyond = [&](std::int32_t corner) {  // from the parent's edge k
          return fine.barycentric[f][as_index(corner % 3)][(k + 2) % 3];
        };
        if (beyond(c) == 0.0 && beyond(c + 1) == 0.0)
          kinds_[as_index(half_edge(face, c))] = coarse.kind(half_edge(parent, k));
      }
  }
  find_pinched(mesh);
  build(mesh, rules);
}

void FeatureLines::orient(const OrderedSurface& mesh, const Context* context) {
  std::vector<OrderedFace> reached;
  for (std::size_t f = 0; f < signs_.size(); ++f) {
    check_at(context, f);
    if (signs_[f] != 0) continue;
    reached.assign(1, nth_face(f));
    signs_[f] = 1;
    double balance = 0.0;
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const OrderedFace face = reached[k];
      balance += signs_[as_index(face)] * mesh.geometry(face).moments.area;
      for (std::int32_t c = 0; c < 3; ++c) {
        const std::int32_t h = half_edge(face, c), g = twin_of(mesh, h);
        if (g < 0 || signs_[as_index(face_of(g))] != 0) continue;
        const bool alike = start_of(mesh, h) != start_of(mesh, g);
        signs_[as_index(face_of(g))] =
            static_cast<std::int8_t>(alike ? signs_[as_index(face)] : -signs_[as_index(face)]);
        reached.push_back(face_of(g));
      }
    }
    if (balance < 0.0)
      for (const OrderedFace face : reached)
        signs_[as_index(face)] = static_cast<std::int8_t>(-signs_[as_index(face)]);
  }
}

void FeatureLines::classify(const OrderedSurface& mesh, const LineRules& rules,
                            const Context* context) {
  const double limit = std::cos(rules.feature_angle * std::numbers::pi / 180.0);
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    check_at(context, k);
    const auto h = static_cast<std::int32_t>(k);
    if (!mesh.counts(face_of(h))) continue;
    const int faces = faces_around(mesh, h);
    if (faces == 1) kinds_[k] = LineKind::kBorder;
    if (faces > 2) kinds_[k] = LineKind::kSeam;
    if (faces != 2) continue;
    const std::int32_t g = mesh.next_around(h);
    const int signs = sign(face_of(h)) * sign(face_of(g));
    const bool alike = start_of(mesh, h) != start_of(mesh, g);
    if ((signs > 0) != alike) {
      kinds_[k] = LineKind::kSeam;
      continue;
    }
    if (rules.feature_angle >= 180.0) continue;
    const std::int32_t left = beside_needles(mesh, h, rules.scale);
    const std::int32_t right = beside_needles(mesh, g, rules.scale);
    if (left < 0 || right < 0) continue;
    const Vec3 a = sign(face_of(left)) * mesh.geometry(face_of(left)).normal;
    const Vec3 b = sign(face_of(right)) * mesh.geometry(face_of(right)).normal;
    if (a.dot(b) < limit) kinds_[k] = LineKind::kCrease;
  }
}

void FeatureLines::mark(const OrderedSurface& mesh,
                        std::span<const std::array<std::int32_t, 2>> marked) {
  if (marked.empty()) return;
  const Connectivity& order = mesh.connectivity();
  std::vector<std::int32_t> ordered(order.original_vertex.size());
  for (std::size_t v = 0; v < ordered.size(); ++v)
    ordered[as_index(order.original_vertex[v])] = static_cast<std::int32_t>(v);
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> edges;
  const auto key = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32U |
           static_cast<std::uint32_t>(std::max(a, b));
  };
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    edges[key(start_of(mesh, h), end_of(mesh, h))].push_back(h);
  }
  for (std::size_t k = 0; k < marked.size(); ++k) {
    const auto found = [&] {
      for (const std::int32_t v : marked[k])
        if (v < 0 || as_index(v) >= ordered.size()) return edges.end();
      return edges.find(key(mesh.welded(ordered[as_index(marked[k][0])]),
                            mesh.welded(ordered[as_index(marked[k][1])])));
    }();
    if (found == edges.end())
      throw ArgumentError(entry("edges", k) + " is (" + std::to_string(marked[k][0]) + ", " +
                          std::to_string(marked[k][1]) + "): no face has this edge");
    for (const std::int32_t h : found->second)
      if (mesh.counts(face_of(h)) &&
          (kinds_[as_index(h)] == LineKind::kNone || kinds_[as_index(h)] == LineKind::kCrease))
        kinds_[as_index(h)] = LineKind::kMarked;
  }
}

/// Find vertices whose faces are more than one fan, connected over edges.
void FeatureLines::find_pinched(const OrderedSurface& mesh) {
  Sets fans(kinds_.size());
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g)) {
      const auto end = [](std::int32_t half) { return half - half % 3 + (half + 1) % 3; };
      const bool opposite = start_of(mesh, h) != start_of(mesh, g);
      fans.join(h, opposite ? end(g) : g);
      fans.join(end(h), opposite ? g : end(g));
    }
  }
  std::vector<std::array<std::int32_t, 2>> seen;  // vertex, fan
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    if (mesh.counts(face_of(h)) && fans.find(h) == h) seen.push_back({start_of(mesh, h), h});
  }
  std::ranges::sort(seen);
  pinched_.clear();
  for (std::size_t k = 1; k < seen.size(); ++k)
    if (seen[k][0] == seen[k - 1][0] && (pinched_.empty() || pinched_.back() != seen[k][0]))
      pinched_.push_back(seen[k][0]);
}

void FeatureLines::drop(const OrderedSurface& mesh, const LineChain& chain) {
  for (const std::int32_t h : chain.half_edges) {
    std::int32_t g = h;
    do {
      kinds_[as_index(g)] = LineKind::kNone;
      g = mesh.next_around(g);
    } while (g != h);
  }
}

/// Drop creases that are noise: the mean normals within a scale on both sides differ less, or those
/// of one side differ as much among each other, or creases on all sides leave no more than a facet.
void FeatureLines::drop_noise(const OrderedSurface& mesh, const LineRules& rules) {
  if (!(rules.scale > 0.0)) return;
  const double limit = std::cos(rules.feature_angle * std::numbers::pi / 180.0);
  std::vector<std::int32_t> noise;
  SideNormals normals(mesh, *this, rules.scale);
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    if (kinds_[k] != LineKind::kCrease || edge_of(mesh, h) != h) continue;
    const Vec3 left = normals.beside(h);
    double extent = normals.extent(), flatness = normals.flatness();
    const Vec3 right = normals.beside(mesh.next_around(h));
    extent = std::min(extent, normals.extent());
    flatness = std::min(flatness, normals.flatness());
    if (left.dot(right) > limit || extent < kFacet * rules.scale || flatness < kFlat)
      noise.push_back(h);
  }
  for (const std::int32_t h : noise) drop(mesh, {{h}, {}});
}

/// Drop creases of noise: connected ones of no length in total, and short ends.
bool FeatureLines::drop_small(const OrderedSurface& mesh, double scale) {
  if (!(scale > 0.0)) return false;
  const Network network(line_edges(mesh, kinds_));
  const std::vector<LineEdge>& edges = network.edges();
  Sets sets(edges.size());
  for (const std::int32_t v : network.vertices())
    for (const auto& entry : network.at(v)) sets.join(network.at(v)[0][1], entry[1]);
  std::vector<double> lengths(edges.size(), 0.0);
  std::vector<bool> fixed(edges.size(), false);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto set = as_index(sets.find(static_cast<std::int32_t>(e)));
    lengths[set] += edges[e].length;
    if (kind(edges[e].half_edge) != LineKind::kCrease) fixed[set] = true;
  }
  bool dropped = false;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto set = as_index(sets.find(static_cast<std::int32_t>(e)));
    if (fixed[set] || lengths[set] >= kLeast * scale) continue;
    drop(mesh, {{edges[e].half_edge}, {}});
    dropped = true;
  }
  for (const std::int32_t v : network.vertices()) {
    if (network.at(v).size() != 1) continue;
    LineChain end;
    std::int32_t at = v, e = network.at(v)[0][1];
    while (e >= 0 && kind(network.edge(e).half_edge) == LineKind::kCrease) {
      end.half_edges.push_back(network.edge(e).half_edge);
      end.length += network.edge(e).length;
      at = network.other_end(e, at);
      if (end.length >= kLeastEnd * scale) break;
      e = network.after(e, at);
    }
    if (end.half_edges.empty() || end.length >= kLeastEnd * scale) continue;
    drop(mesh, end);
    dropped = true;
  }
  return dropped;
}

std::size_t FeatureLines::drop_chains(const Surface& surface, const std::vector<bool>& chosen,
                                      LineKind kind_of_them, const LineRules& rules) {
  std::size_t dropped = 0;
  for (std::size_t k = 0; k < chains_.size(); ++k) {
    if (!chosen[k] || kind(chains_[k].half_edges.front()) != kind_of_them) continue;
    drop(surface.ordered(), chains_[k]);
    ++dropped;
  }
  chains_.clear();
  corners_.clear();
  corner_half_edges_.clear();
  build(surface.ordered(), rules);
  return dropped;
}

void FeatureLines::build(const OrderedSurface& mesh, const LineRules& rules) {
  const Network network(line_edges(mesh, kinds_));
  const double limit = std::cos(rules.corner_angle * std::numbers::pi / 180.0);
  std::vector<bool> corner(mesh.vertex_count(), false);
  std::vector<std::pair<double, std::int32_t>> turns;
  for (const std::int32_t v : network.vertices()) {
    if (network.at(v).size() != 2)
      corner[as_index(v)] = true;
    else if (const double turn = network.turn(mesh, v, rules.scale); turn < limit)
      turns.push_back({turn, v});
  }
  keep_sharpest(mesh, rules.scale, turns);
  for (const auto& [turn, v] : turns) corner[as_index(v)] = true;
  for (const std::int32_t v : pinched_) corner[as_index(v)] = true;
  std::vector<bool> used(network.edges().size(), false);
  chain_of_.assign(kinds_.size(), -1);
  const auto follow = [&](std::int32_t from, std::int32_t e) {
    LineChain chain;
    chain.vertices.push_back(from);
    for (std::int32_t at = from; e >= 0 && !used[as_index(e)];) {
      used[as_index(e)] = true;
      chain.half_edges.push_back(network.edge(e).half_edge);
      chain.length += network.edge(e).length;
      chain.vertices.push_back(at = network.other_end(e, at));
      e = corner[as_index(at)] ? -1 : network.after(e, at);
    }
    chain.closed = chain.vertices.back() == from && !corner[as_index(from)];
    for (const std::int32_t h : chain.half_edges) {
      std::int32_t g = h;
      do {
        chain_of_[as_index(g)] = static_cast<std::int32_t>(chains_.size());
        g = mesh.next_around(g);
      } while (g != h);
    }
    chains_.push_back(std::move(chain));
  };
  for (const std::int32_t v : network.vertices())
    if (corner[as_index(v)])
      for (const auto& entry : network.at(v))
        if (!used[as_index(entry[1])]) follow(v, entry[1]);
  for (std::size_t e = 0; e < used.size(); ++e)
    if (!used[e]) follow(network.edges()[e].from, static_cast<std::int32_t>(e));
  std::vector<std::int32_t> at(mesh.vertex_count(), -1);
  for (std::size_t h = 0; h < kinds_.size(); ++h)
    if (mesh.counts(face_of(static_cast<std::int32_t>(h))))
      at[as_index(start_of(mesh, static_cast<std::int32_t>(h)))] = static_cast<std::int32_t>(h);
  for (std::size_t v = 0; v < corner.size(); ++v)
    if (corner[v] && at[v] >= 0) {
      corners_.push_back(static_cast<std::int32_t>(v));
      corner_half_edges_.push_back(at[v]);
    }
}

Sites point_on_edge(const OrderedSurface& mesh, std::int32_t half_edge, double t) {
  Vec3 weights = Vec3::Zero();
  weights[half_edge % 3] = 1.0 - t;
  weights[(half_edge + 1) % 3] = t;
  const OrderedFace face = face_of(half_edge);
  return {{mesh.point(face, weights)}, {mesh.original_face(face)}, {weights}};
}

Sites point_on_chain(const OrderedSurface& mesh, const LineChain& chain, bool forward,
                     double distance) {
  const std::size_t count = chain.half_edges.size();
  const Vec3 origin = place_of(mesh, forward ? chain.vertices.front() : chain.vertices.back());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t e = forward ? k : count - 1 - k;
    const std::int32_t next = chain.vertices[forward ? e + 1 : e];
    const std::int32_t before = chain.vertices[forward ? e : e + 1];
    const double far = (place_of(mesh, next) - origin).norm();
    if (far < distance) continue;
    const double near = (place_of(mesh, before) - origin).norm();
    const double share = far > near ? std::clamp((distance - near) / (far - near), 0.0, 1.0) : 0.0;
    const std::int32_t h = chain.half_edges[e];
    return point_on_edge(mesh, h, start_of(mesh, h) == before ? share : 1.0 - share);
  }
  return {};
}

LineSites sites_on_lines(const Surface& surface, const FeatureLines& lines, double unit) {
  const OrderedSurface& mesh = surface.ordered();
  LineSites result;
  result.corners = lines.corners().size();
  for (std::size_t k = 0; k < result.corners; ++k) {
    append_point(result.sites, point_on_edge(mesh, lines.half_edge_at(k), 0.0));
    result.chains.push_back(-1);
  }
  const std::vector<double> fewest = fewest_parts(lines.chains());
  for (std::size_t k = 0; k < fewest.size(); ++k)
    place_along(mesh, lines.chains()[k], unit, fewest[k], static_cast<std::int32_t>(k), result);
  return result;
}

double metric_length(const Surface& surface, const FeatureLines& lines, bool borders_only) {
  double total = 0.0;
  for (const LineChain& chain : lines.chains())
    for (const std::int32_t h : chain.half_edges)
      if (!borders_only || lines.kind(h) == LineKind::kBorder)
        total += metric(surface.ordered(), h);
  return total;
}

}  // namespace dapple
