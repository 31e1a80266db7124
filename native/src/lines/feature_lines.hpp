// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/context.hpp>
#include <dapple/refine.hpp>
#include <dapple/surface.hpp>
#include <span>
#include <vector>

#include "surface/ordered_face.hpp"

namespace dapple {

/// Why an edge is part of a line.
enum class LineKind : std::uint8_t {
  kNone,
  kBorder,  ///< it has one face
  kSeam,    ///< three or more faces meet, or two of opposite orientation
  kMarked,  ///< the caller has marked it
  kCrease,  ///< its faces differ by more than the feature angle
};

/// Which edges count as lines.
struct LineRules {
  double feature_angle = 30.0;  ///< degrees; 180: no edge is a crease
  double corner_angle = 45.0;   ///< degrees by which a line turns at a corner
  /// Distance over which turns are measured. Lines of creases that are shorter in total are left
  /// out, and so are shorter ends of them.
  double scale = 0.0;
  std::span<const std::array<std::int32_t, 2>> marked = {};  ///< by the caller's vertices
};

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
  void mark(const OrderedSurface& mesh, std::span<const std::array<std::int32_t, 2>> marked);
  void build(const OrderedSurface& mesh, const LineRules& rules);
  void drop(const OrderedSurface& mesh, const LineChain& chain);
  void drop_noise(const OrderedSurface& mesh, const LineRules& rules);
  [[nodiscard]] bool drop_small(const OrderedSurface& mesh, double scale);
  void find_pinched(const OrderedSurface& mesh);

  std::vector<LineKind> kinds_;  // per half-edge
  std::vector<std::int8_t> signs_;
  std::vector<LineChain> chains_;
  std::vector<std::int32_t> chain_of_;  // per half-edge
  std::vector<std::int32_t> corners_, corner_half_edges_, pinched_;
};

/// The lowest half-edge of an edge, which stands for it.
[[nodiscard]] std::int32_t edge_of(const OrderedSurface& mesh, std::int32_t half_edge);

/// Points on lines, as sites.
struct LineSites {
  Sites sites;                       ///< corners first, then chain after chain
  std::size_t corners = 0;           ///< the first ones
  std::vector<std::int32_t> chains;  ///< per site: its chain; -1 for corners
};

/// A point on an edge.
[[nodiscard]] Sites point_on_edge(const OrderedSurface& mesh, std::int32_t half_edge, double t);

/// The point of a chain at a straight distance from its first vertex, or from its last; none if it
/// is shorter.
[[nodiscard]] Sites point_on_chain(const OrderedSurface& mesh, const LineChain& chain, bool forward,
                                   double distance);

/// Corners, and points evenly along each chain, by the local spacing `unit / sqrt(density)`; a
/// closed chain gets three at least.
[[nodiscard]] LineSites sites_on_lines(const Surface& surface, const FeatureLines& lines,
                                       double unit);

/// The length of all chains, or of borders alone, where the local unit is 1 / sqrt(density).
[[nodiscard]] double metric_length(const Surface& surface, const FeatureLines& lines,
                                   bool borders_only);

}  // namespace dapple
