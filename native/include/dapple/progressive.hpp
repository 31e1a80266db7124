// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// An order of points in which every beginning is even: the rank of each, 0..n-1, so that the m
/// points with the smallest ranks are spread as evenly as such a part can be, for every m. For
/// showing a share of a scatter, and for levels of detail.
///
/// Points are taken away one by one, always the one that is nearest to the others, as weighted
/// sample elimination does (Yuksel 2015). Distances are compared with those that the points have
/// all together, so that a density is kept. With classes, every class is even by itself as well,
/// and keeps its share of the points to within one.
/// \param classes  >= 0, one per point, or empty: all are alike
/// \return for the same points, the same ranks; ties are broken by index
/// \throw ArgumentError naming the first point that is not finite, class below 0; if the lengths
/// differ; Cancelled
[[nodiscard]] std::vector<std::int32_t> progressive_ranks(
    std::span<const Vec3> points, std::span<const std::int32_t> classes = {},
    Context* context = nullptr);

}  // namespace dapple
