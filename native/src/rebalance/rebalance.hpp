// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <limits>

namespace dapple {

inline constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

/// Sites of another number or under another density, before they are made even.
struct Rebalanced {
  std::vector<std::size_t> stay;  ///< indices of the sites that stay, in their order
  Sites fresh;                    ///< those that are put in
  int evaluations = 0;            ///< of the cells
};

/// What it takes to come from one number of sites to another, in evaluations of one cell.
[[nodiscard]] double rebalancing_work(std::size_t sites, std::size_t count);

/// Take out sites and put in others, so that each neighborhood of a few sites has the number that
/// its share of the density asks for. Whatever has to be made up over a longer distance is then
/// made up, and an optimization moves no site far. Those with the smallest cells are taken out, far
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

/// Some of the sites, which alone may go.
struct FreeSites {
  std::vector<bool> free;     ///< per site
  double capacity = 0.0;      ///< what each of them should have: > 0, as the domain's integrals
  RestrictedVoronoi diagram;  ///< the cells of all sites
};

/// Sites of which some were taken out.
struct Thinned {
  std::vector<std::size_t> stay;  ///< indices of the sites that stay, in their order
  std::size_t lacking = 0;        ///< how many should be put in
  int evaluations = 0;            ///< of the cells, but for those given
};

/// The same for a part of the sites, but for putting in.
/// \throw Cancelled
[[nodiscard]] Thinned thin_out(const Surface& surface, const Domain& domain, const Sites& sites,
                               FreeSites part, Context* context);

}  // namespace dapple
