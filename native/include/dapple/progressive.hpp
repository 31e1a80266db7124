// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// A progressive order of points: ranks 0..n-1 such that, for every m, the m points with the
/// smallest ranks are as evenly spread as a subset can be. For showing a part of a scatter, and for
/// levels of detail.
///
/// Points are removed one by one, always the most crowded one, by weighted sample elimination
/// (Yuksel 2015). Distances are taken relative to the local spacing of all points, so a density is
/// preserved. With classes, every class is even by itself as well, and keeps its share of the
/// points to within one.
/// \param classes  >= 0, one per point, or empty: one class
/// \return the ranks; ties are broken by index
/// \throw ArgumentError naming the first point that is not finite, class below 0; if the lengths
/// differ; Cancelled
[[nodiscard]] std::vector<std::int32_t> progressive_ranks(
    std::span<const Vec3> points, std::span<const std::int32_t> classes = {},
    Context* context = nullptr);

}  // namespace dapple
