// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Which points an eye sees: nothing of the surface is between them and the eye. Faces block from
/// both sides; those nearer to a point than a few millionths of the surface's size do not, so
/// points may lie on it.
///
/// \param eye in homogeneous coordinates: a place with 1 at the end, or, for parallel light, the
///            direction to the eye with 0 at the end
/// \return 1 or 0 per point
/// \throw ArgumentError if the eye is not finite or its last number is neither 0 nor 1, or its
///        direction has no length; naming the first point that is not finite; Cancelled
[[nodiscard]] std::vector<std::uint8_t> seen_from(const Surface& surface,
                                                  const std::array<double, 4>& eye,
                                                  std::span<const Vec3> points,
                                                  Context* context = nullptr);

}  // namespace dapple
