// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/domain.hpp>

#include "track/transfer.hpp"

namespace dapple {

/// Initial places of samples on a surface of other faces: first those that stay, then those that
/// are born.
struct Turnover {
  Sites sites;
  std::vector<std::int32_t> origin;  ///< per site its previous index, or -1
};

/// Births and deaths on a surface of other faces. Samples with the least room die first, and new
/// ones are born where there is most. If the area is unchanged, at most 0.5 % of the samples come
/// and go.
/// \param domain of the surface
/// \param there the samples that have a place
/// \param before previous number of samples
/// \param count wanted number of samples
/// \throw Cancelled
[[nodiscard]] Turnover turn_over(const Surface& surface, const Domain& domain,
                                 const Transferred& there, std::size_t before, std::size_t count,
                                 std::uint64_t seed, Context* context);

}  // namespace dapple
