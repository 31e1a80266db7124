// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/feature_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <unordered_map>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "lines/crease_noise.hpp"
#include "lines/line_network.hpp"
#include "lines/needles.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;  // half-edges
constexpr double kRounding = 1e-9;    // of the cosine of a turn: octagons turn by 45 degrees

/// Of the corners along a line that turns over several edges, only the sharpest within the scale
/// stays.
void keep_sharpest(const OrderedSurface& mesh, double scale,
                   std::vector<std::pair<double, std::int32_t>>& turns) {
  std::ranges::sort(turns);
  std::vector<std::pair<double, std::int32_t>> kept;
  for (const auto& turn : turns) {
    const Vec3 here = mesh.vertex(turn.second);
    if (std::ranges::none_of(kept, [&](const auto& other) {
          return (mesh.vertex(other.second) - here).norm() < scale;
        }))
      kept.push_back(turn);
  }
  turns = std::move(kept);
}

}  // namespace

FeatureLines::FeatureLines(const Surface& surface, const LineRules& rules, const Context* context)
    : kinds_(3 * surface.face_count(), LineKind::kNone), signs_(surface.face_count(), 0) {
  const OrderedSurface& mesh = surface.ordered();
  orient(mesh, context);
  classify(mesh, rules, context);
  mark(mesh, rules.marked);
  find_pinched(mesh);
  drop_noise(mesh, signs_, rules, context, kinds_);
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
  parallel_chunks(kinds_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    for (std::size_t k = begin; k < end; ++k)
      kinds_[k] = classified(mesh, static_cast<std::int32_t>(k), rules, limit);
  });
}

/// What a half-edge is by the faces around it.
/// \param limit cosine of the feature angle
LineKind FeatureLines::classified(const OrderedSurface& mesh, std::int32_t h,
                                  const LineRules& rules, double limit) const {
  if (!mesh.counts(face_of(h))) return LineKind::kNone;
  const int faces = faces_around(mesh, h);
  if (faces == 1 && rules.borders) return LineKind::kBorder;
  if (faces > 2 && rules.borders) return LineKind::kSeam;
  if (faces != 2) return LineKind::kNone;
  const std::int32_t g = mesh.next_around(h);
  const int signs = sign(face_of(h)) * sign(face_of(g));
  const bool alike = start_of(mesh, h) != start_of(mesh, g);
  if ((signs > 0) != alike) return rules.borders ? LineKind::kSeam : LineKind::kNone;
  if (rules.feature_angle >= 180.0) return LineKind::kNone;
  const std::int32_t left = beside_needles(mesh, h, rules.scale);
  const std::int32_t right = beside_needles(mesh, g, rules.scale);
  if (left < 0 || right < 0) return LineKind::kNone;
  const Vec3 a = sign(face_of(left)) * mesh.geometry(face_of(left)).normal;
  const Vec3 b = sign(face_of(right)) * mesh.geometry(face_of(right)).normal;
  return a.dot(b) < limit ? LineKind::kCrease : LineKind::kNone;
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
  Sets fans = fans_of(mesh);
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

std::size_t FeatureLines::drop_chains(const Surface& surface, const std::vector<bool>& chosen,
                                      LineKind kind_of_them, const LineRules& rules) {
  std::size_t dropped = 0;
  for (std::size_t k = 0; k < chains_.size(); ++k) {
    if (!chosen[k] || kind(chains_[k].half_edges.front()) != kind_of_them) continue;
    for (const std::int32_t h : chains_[k].half_edges) drop_edge(surface.ordered(), h, kinds_);
    ++dropped;
  }
  chains_.clear();
  corners_.clear();
  corner_half_edges_.clear();
  build(surface.ordered(), rules);
  return dropped;
}

void FeatureLines::build(const OrderedSurface& mesh, const LineRules& rules) {
  const LineNetwork network(line_edges(mesh, kinds_));
  const double limit = std::cos(rules.corner_angle * std::numbers::pi / 180.0) - kRounding;
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
      for_each_half_edge(mesh, h, [&](std::int32_t g) {
        chain_of_[as_index(g)] = static_cast<std::int32_t>(chains_.size());
      });
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

}  // namespace dapple
