// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <unordered_map>
#include <vector>

#include "lines/feature_lines.hpp"

namespace dapple {

/// Where a point is on the lines of a surface.
struct LinePlace {
  std::int32_t corner = -1;  ///< index of the corner that it is at; -1: at none
  std::int32_t chain = -1;   ///< that it is on; -1: on none, or at a corner
  std::size_t edge = 0;      ///< the chain's edge
  double share = 0.0;        ///< of that edge, from its first vertex in the chain's direction

  [[nodiscard]] bool is_on_line() const { return corner >= 0 || chain >= 0; }
};

/// Finds points on lines.
class LinePlaces {
 public:
  /// \param surface, lines must outlive it
  LinePlaces(const Surface& surface, const FeatureLines& lines);

  /// The place of a point of a face on the lines at that face, if one is within a distance.
  [[nodiscard]] LinePlace find(std::int32_t face, const Vec3& point, double tolerance) const;

  /// The site at a place. \pre it is on a line
  [[nodiscard]] Sites site_at(const LinePlace& place) const;

 private:
  [[nodiscard]] LinePlace at_vertex(std::int32_t vertex) const;

  const OrderedSurface& mesh_;
  const FeatureLines& lines_;
  std::vector<std::size_t> edge_of_;  // per half-edge, its place in its chain
  std::unordered_map<std::int32_t, LinePlace> at_vertices_;
};

}  // namespace dapple
