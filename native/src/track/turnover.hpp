// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/domain.hpp>

#include "track/transfer.hpp"

namespace dapple {

/// Where samples begin on a surface of other faces: those that stay, then those that are born.
struct Turnover {
  Sites sites;
  std::vector<std::int32_t> origin;  ///< per site its index so far, or -1
};

/// Births and deaths on a surface of other faces. Those die first that have least room, and the
/// others are born where there is most. Where the area is as large as before, no more than 0.5 % of
/// the samples come and go.
/// \param domain of the surface
/// \param there the samples that have a place
/// \param before how many there were
/// \param count how many there are to be
/// \throw Cancelled
[[nodiscard]] Turnover turn_over(const Surface& surface, const Domain& domain,
                                 const Transferred& there, std::size_t before, std::size_t count,
                                 std::uint64_t seed, Context* context);

}  // namespace dapple
