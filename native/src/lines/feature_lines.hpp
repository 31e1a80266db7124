// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/context.hpp>
#include <dapple/refine.hpp>
#include <dapple/surface.hpp>
#include <span>
#include <vector>

#include "lines/line_edges.hpp"
#include "surface/ordered_face.hpp"

namespace dapple {

/// A line between corners, or a closed one without any.
struct LineChain {
  std::vector<std::int32_t> half_edges;  ///< ordered ones, one for each edge
  std::vector<std::int32_t> vertices;    ///< welded; one more than edges
  bool closed = false;                   ///< the last vertex is the first
  double length = 0.0;
};

/// The lines of a surface: borders, creases, marked edges, and edges where faces are not manifold.
/// Half-edges and vertices are those of OrderedSurface.
class FeatureLines {
 public:
  /// \throw ArgumentError naming the first marked edge that is none; Cancelled
  FeatureLines(const Surface& surface, const LineRules& rules, const Context* context = nullptr);

  /// The lines of a surface on the same one with finer faces.
  FeatureLines(const Refined& fine, const FeatureLines& coarse, const LineRules& rules);

  [[nodiscard]] LineKind kind(std::int32_t half_edge) const {
    return kinds_[static_cast<std::size_t>(half_edge)];
  }
  [[nodiscard]] bool is_line(std::int32_t half_edge) const {
    return kind(half_edge) != LineKind::kNone;
  }
  /// 1, or -1 for a face that is turned over, so that neighbors agree wherever they can.
  [[nodiscard]] int sign(OrderedFace face) const { return signs_[as_index(face)]; }

  [[nodiscard]] const std::vector<LineChain>& chains() const { return chains_; }
  /// The chain that an edge is part of; -1: none.
  [[nodiscard]] std::int32_t chain_of(std::int32_t half_edge) const {
    return chain_of_[static_cast<std::size_t>(half_edge)];
  }
  /// Drop those of the chosen chains that are of a kind; chains and corners are then new ones.
  /// \return how many
  std::size_t drop_chains(const Surface& surface, const std::vector<bool>& chosen,
                          LineKind kind_of_them, const LineRules& rules);
  /// Welded vertices where lines end, meet or turn, or where faces touch at a point; ascending.
  [[nodiscard]] const std::vector<std::int32_t>& corners() const { return corners_; }
  /// A half-edge that starts at each corner, or ends there; see corner_at_start().
  [[nodiscard]] std::int32_t half_edge_at(std::size_t corner) const {
    return corner_half_edges_[corner];
  }

 private:
  void orient(const OrderedSurface& mesh, const Context* context);
  void classify(const OrderedSurface& mesh, const LineRules& rules, const Context* context);
  [[nodiscard]] LineKind classified(const OrderedSurface& mesh, std::int32_t h,
                                    const LineRules& rules, double limit) const;
  void mark(const OrderedSurface& mesh, std::span<const std::array<std::int32_t, 2>> marked);
  void build(const OrderedSurface& mesh, const LineRules& rules);
  void find_pinched(const OrderedSurface& mesh);

  std::vector<LineKind> kinds_;  // per half-edge
  std::vector<std::int8_t> signs_;
  std::vector<LineChain> chains_;
  std::vector<std::int32_t> chain_of_;  // per half-edge
  std::vector<std::int32_t> corners_, corner_half_edges_, pinched_;
};

}  // namespace dapple
