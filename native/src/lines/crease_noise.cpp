// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/crease_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/progress.hpp"
#include "base/sets.hpp"
#include "lines/line_network.hpp"

namespace dapple {
namespace {

// Creases of scans are many short ones, which end in the middle of smooth parts.
constexpr double kLeast = 6.0;     // scales: length of creases that meet, in total
constexpr double kLeastEnd = 4.0;  // scales: length of a crease that ends nowhere
constexpr double kFlat = 0.95;     // folds of rough parts are no creases
constexpr double kFacet = 0.6;     // of the scale: parts between creases that reach less are noise
// Sharp edges of scans lie about singly: two loose ends in about four. In models that were
// constructed they form lines, and low-poly models have more of them.
constexpr double kLooseEnds = 1.0 / 3.0;  // of the sharp edges of a connected part: it is rough
constexpr double kSharp = 0.16;           // of its edges: low-poly models have more
constexpr std::size_t kFewest = 30;       // sharp edges that can be judged
constexpr double kSharper = 30.0;  // degrees: half of the creases that meet there differ by more
constexpr double kLonger = 12.0;   // scales: their length in total

/// Mean normals of the surface on one side of an edge, up to the next lines.
class SideNormals {
 public:
  SideNormals(const OrderedSurface& mesh, std::span<const LineKind> kinds,
              std::span<const std::int8_t> signs, double reach)
      : mesh_(mesh), kinds_(kinds), signs_(signs), reach_(reach), stamps_(mesh.face_count(), -1) {}

  [[nodiscard]] Vec3 beside(std::int32_t h) {
    const Vec3 middle = 0.5 * (mesh_.vertex(start_of(mesh_, h)) + mesh_.vertex(end_of(mesh_, h)));
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
      sum += signs_[as_index(reached_[k])] * geometry.moments.area * geometry.normal;
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
    if (kinds_[as_index(h)] != LineKind::kNone) return;
    const OrderedFace next = face_of(mesh_.next_around(h));
    if (stamps_[as_index(next)] == stamp_) return;
    stamps_[as_index(next)] = stamp_;
    if ((mesh_.geometry(next).centroid - middle).norm() <= reach_) reached_.push_back(next);
  }

  const OrderedSurface& mesh_;
  std::span<const LineKind> kinds_;
  std::span<const std::int8_t> signs_;
  double reach_;
  std::vector<std::int32_t> stamps_;
  std::int32_t stamp_ = -1;
  double extent_ = 0.0, flatness_ = 0.0;
  std::vector<OrderedFace> reached_;
};

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

/// Drop creases whose mean normals within a scale on both sides differ less, or those of one side
/// differ as much among each other, or where creases on all sides leave no more than a facet.
void drop_flat(const OrderedSurface& mesh, std::span<const std::int8_t> signs,
               const LineRules& rules, std::vector<LineKind>& kinds) {
  std::vector<std::int32_t> noise;
  SideNormals normals(mesh, kinds, signs, rules.scale);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto h = static_cast<std::int32_t>(k);
    if (kinds[k] != LineKind::kCrease || edge_of(mesh, h) != h) continue;
    const Vec3 left = normals.beside(h);
    double extent = normals.extent(), flatness = normals.flatness();
    const Vec3 right = normals.beside(mesh.next_around(h));
    extent = std::min(extent, normals.extent());
    flatness = std::min(flatness, normals.flatness());
    if (left.dot(right) > cosine(rules.feature_angle) || extent < kFacet * rules.scale ||
        flatness < kFlat)
      noise.push_back(h);
  }
  for (const std::int32_t h : noise) drop_edge(mesh, h, kinds);
}

/// The connected lines that each edge of a network is part of.
Sets connected(const LineNetwork& network) {
  Sets sets(network.edges().size());
  for (const std::int32_t v : network.vertices())
    for (const auto& entry : network.at(v)) sets.join(network.at(v)[0][1], entry[1]);
  return sets;
}

/// Drop creases of no length: connected ones in total, and short ends.
bool drop_small(const OrderedSurface& mesh, double scale, std::vector<LineKind>& kinds) {
  const LineNetwork network(line_edges(mesh, kinds));
  const std::vector<LineEdge>& edges = network.edges();
  const auto is_crease = [&](const LineEdge& edge) {
    return kinds[as_index(edge.half_edge)] == LineKind::kCrease;
  };
  Sets sets = connected(network);
  std::vector<double> lengths(edges.size(), 0.0);
  std::vector<bool> fixed(edges.size(), false);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto set = as_index(sets.find(static_cast<std::int32_t>(e)));
    lengths[set] += edges[e].length;
    if (!is_crease(edges[e])) fixed[set] = true;
  }
  bool dropped = false;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto set = as_index(sets.find(static_cast<std::int32_t>(e)));
    if (fixed[set] || lengths[set] >= kLeast * scale) continue;
    drop_edge(mesh, edges[e].half_edge, kinds);
    dropped = true;
  }
  for (const std::int32_t v : network.vertices()) {
    if (network.at(v).size() != 1) continue;
    std::vector<std::int32_t> end;
    double length = 0.0;
    std::int32_t at = v, e = network.at(v)[0][1];
    while (e >= 0 && is_crease(network.edge(e)) && length < kLeastEnd * scale) {
      end.push_back(network.edge(e).half_edge);
      length += network.edge(e).length;
      at = network.other_end(e, at);
      e = network.after(e, at);
    }
    if (end.empty() || length >= kLeastEnd * scale) continue;
    for (const std::int32_t h : end) drop_edge(mesh, h, kinds);
    dropped = true;
  }
  return dropped;
}

/// The parts of a surface that are connected over edges, by face.
Sets parts_of(const OrderedSurface& mesh, std::size_t faces) {
  Sets parts(faces);
  for (std::size_t k = 0; k < 3 * faces; ++k) {
    const auto h = static_cast<std::int32_t>(k);
    parts.join(h / 3, mesh.next_around(h) / 3);
  }
  return parts;
}

std::vector<LineKind> creases_of(std::span<const LineKind> kinds) {
  std::vector<LineKind> result(kinds.begin(), kinds.end());
  std::ranges::replace_if(
      result, [](LineKind kind) { return kind != LineKind::kCrease; }, LineKind::kNone);
  return result;
}

/// Per face whether it is of a rough part: one whose sharp edges mostly end in nothing.
std::vector<bool> rough_faces(const OrderedSurface& mesh, std::span<const LineKind> kinds) {
  const std::size_t count = kinds.size() / 3;
  Sets parts = parts_of(mesh, count);
  std::vector<std::size_t> faces(count, 0), sharp(count, 0), ends(count, 0);
  const auto part_of = [&](std::int32_t face) { return as_index(parts.find(face)); };
  for (std::size_t f = 0; f < count; ++f) ++faces[part_of(static_cast<std::int32_t>(f))];
  const LineNetwork network(line_edges(mesh, creases_of(kinds)));
  for (const LineEdge& edge : network.edges()) ++sharp[part_of(edge.half_edge / 3)];
  for (const std::int32_t v : network.vertices())
    if (const auto around = network.at(v); around.size() == 1)
      ++ends[part_of(network.edge(around[0][1]).half_edge / 3)];
  std::vector<bool> result(count);
  for (std::size_t f = 0; f < count; ++f) {
    const std::size_t part = part_of(static_cast<std::int32_t>(f));
    const auto found = static_cast<double>(sharp[part]);
    result[f] = sharp[part] >= kFewest && static_cast<double>(ends[part]) > kLooseEnds * found &&
                found < kSharp * 1.5 * static_cast<double>(faces[part]);
  }
  return result;
}

/// Drop creases of rough parts at loose ends until only closed lines are left, and what connects
/// them.
void drop_open(const OrderedSurface& mesh, const std::vector<bool>& rough,
               std::vector<LineKind>& kinds) {
  const LineNetwork network(line_edges(mesh, creases_of(kinds)));
  std::vector<bool> gone(network.edges().size(), false);
  const auto only_edge_at = [&](std::int32_t v) {
    std::int32_t found = -1;
    for (const auto& [_, e] : network.at(v)) {
      if (gone[as_index(e)]) continue;
      if (found >= 0) return -1;
      found = e;
    }
    return found;
  };
  for (std::int32_t v : network.vertices())
    for (std::int32_t e = only_edge_at(v); e >= 0; e = only_edge_at(v)) {
      if (!rough[as_index(network.edge(e).half_edge / 3)]) break;
      gone[as_index(e)] = true;
      drop_edge(mesh, network.edge(e).half_edge, kinds);
      v = network.other_end(e, v);
    }
}

/// Drop creases of rough parts, except for long and sharp ones that are closed.
void drop_rough(const OrderedSurface& mesh, std::span<const std::int8_t> signs,
                const LineRules& rules, const std::vector<bool>& rough,
                std::vector<LineKind>& kinds) {
  drop_open(mesh, rough, kinds);
  const LineNetwork network(line_edges(mesh, creases_of(kinds)));
  const std::vector<LineEdge>& edges = network.edges();
  Sets sets = connected(network);
  const auto set_of = [&](std::size_t e) {
    return as_index(sets.find(static_cast<std::int32_t>(e)));
  };
  std::vector<double> lengths(edges.size(), 0.0), sharp(edges.size(), 0.0);
  const double limit = cosine(std::min(rules.feature_angle + kSharper, 180.0));
  SideNormals normals(mesh, kinds, signs, rules.scale);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::int32_t h = edges[e].half_edge;
    if (!rough[as_index(h / 3)]) continue;
    lengths[set_of(e)] += edges[e].length;
    const Vec3 left = normals.beside(h), right = normals.beside(mesh.next_around(h));
    if (left.dot(right) < limit) sharp[set_of(e)] += edges[e].length;
  }
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::size_t set = set_of(e);
    if (rough[as_index(edges[e].half_edge / 3)] &&
        (lengths[set] < kLonger * rules.scale || sharp[set] < 0.5 * lengths[set]))
      drop_edge(mesh, edges[e].half_edge, kinds);
  }
}

}  // namespace

void drop_noise(const OrderedSurface& mesh, std::span<const std::int8_t> signs,
                const LineRules& rules, const Context* context, std::vector<LineKind>& kinds) {
  if (!(rules.scale > 0.0)) return;
  const std::vector<bool> rough = rough_faces(mesh, kinds);
  drop_flat(mesh, signs, rules, kinds);
  while (drop_small(mesh, rules.scale, kinds)) check_context(context);
  drop_rough(mesh, signs, rules, rough, kinds);
}

void drop_edge(const OrderedSurface& mesh, std::int32_t half_edge, std::vector<LineKind>& kinds) {
  for_each_half_edge(mesh, half_edge,
                     [&](std::int32_t h) { kinds[as_index(h)] = LineKind::kNone; });
}

}  // namespace dapple
