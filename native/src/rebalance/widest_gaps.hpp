// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// What new sites are put among.
struct Gaps {
  Sites sites;             ///< that are there, at least one, with barycentric coordinates
  std::vector<bool> open;  ///< per site: whether there may be new ones in its cell
  double capacity = 0.0;   ///< of a site, in the unit of the surface's cells: > 0
};

/// Places for new sites: each in the widest gap that those before it leave, in spacings at the
/// place, so that they fill a void evenly (farthest point strategy, Eldar et al. 1997). They are
/// chosen among random points; fewer than `count` if no more lie in cells of open sites.
/// \throw Cancelled
[[nodiscard]] Sites widest_gaps(const Surface& surface, const Gaps& gaps, std::size_t count,
                                std::uint64_t seed, const Context* context);

}  // namespace dapple
