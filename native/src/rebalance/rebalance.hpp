// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <limits>

namespace dapple {

inline constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

/// Sites of another number or under another density, before the optimization.
struct Rebalanced {
  std::vector<std::size_t> stay;  ///< indices of the sites that stay, in their order
  Sites fresh;                    ///< inserted sites
  int evaluations = 0;            ///< of the cells
};

/// The cost of changing the number of sites, in evaluations of one cell.
[[nodiscard]] double rebalancing_work(std::size_t sites, std::size_t count);

/// Remove and insert sites so that each neighborhood of a few sites has the number that fits its
/// share of the density. Then densities are right over longer distances, and an optimization moves
/// no site far. Those with the smallest cells are taken out, far
/// from each other; new ones come into the widest gaps of the largest cells. A neighborhood that
/// has its number to within a sample is left alone.
/// \param sites with barycentric coordinates; at least one
/// \param count at least one
/// \param pairs how many may at most be put in while others are taken out: where that is too few,
///              those neighborhoods come first that lack or have most
/// \throw Cancelled
[[nodiscard]] Rebalanced rebalance(const Domain& domain, const Sites& sites, std::size_t count,
                                   std::uint64_t seed, Context* context,
                                   std::size_t pairs = kAnyNumber);

/// Disjoint sets of sites, and how many each is to gain or to lose.
struct Exchange {
  std::vector<std::size_t> of_sites;    ///< per site, its place
  std::vector<std::ptrdiff_t> changes;  ///< per place
};

/// Move sites between places: those with the smallest cells of a place are taken out, and new ones
/// come into the widest gaps of the largest cells of another.
/// \param sites with barycentric coordinates, and their cells
[[nodiscard]] Rebalanced move_between(const Domain& domain, const Sites& sites,
                                      const RestrictedVoronoi& diagram, const Exchange& places,
                                      std::uint64_t seed);

/// Some of the sites, which alone may go.
struct FreeSites {
  std::vector<bool> free;     ///< per site
  double capacity = 0.0;      ///< target capacity of each: > 0, as the domain's integrals
  RestrictedVoronoi diagram;  ///< the cells of all sites
};

/// Sites of which some were taken out.
struct Thinned {
  std::vector<std::size_t> stay;  ///< indices of the sites that stay, in their order
  std::size_t lacking = 0;        ///< number of sites to insert
  int evaluations = 0;            ///< of the cells, but for those given
};

/// The same for a part of the sites, without insertions.
/// \throw Cancelled
[[nodiscard]] Thinned thin_out(const Surface& surface, const Domain& domain, const Sites& sites,
                               FreeSites part, Context* context);

}  // namespace dapple
