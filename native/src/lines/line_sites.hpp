// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <vector>

#include "lines/feature_lines.hpp"

namespace dapple {

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

/// A place on a chain.
struct ChainPlace {
  std::size_t edge = 0;
  double share = 0.0;  ///< of the edge, from its first vertex in the chain's direction
};

[[nodiscard]] Sites point_on_chain(const OrderedSurface& mesh, const LineChain& chain,
                                   const ChainPlace& place);

/// Sites that are on lines already. Empty: none.
struct KeptOnLines {
  std::vector<bool> corners;                    ///< per corner, whether there is one
  std::vector<std::vector<ChainPlace>> places;  ///< per chain
};

/// Corners, and points evenly along each chain, by the local spacing `unit / sqrt(density)`; a
/// closed chain gets three at least.
/// \param kept they are left out, and others are spaced between them
[[nodiscard]] LineSites sites_on_lines(const Surface& surface, const FeatureLines& lines,
                                       double unit, const KeptOnLines& kept = {});

/// The length of all chains, or of borders alone, where the local unit is 1 / sqrt(density).
[[nodiscard]] double metric_length(const Surface& surface, const FeatureLines& lines,
                                   bool borders_only);

}  // namespace dapple
