// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <functional>
#include <vector>

namespace dapple {

/// The sides of a face from which it can be seen; the front is where the normal points.
enum class Sides : std::uint8_t { kBoth, kFront, kBack };

/// The shares of free directions over the front and over the back of a place.
using FreeOnSides = std::function<std::array<double, 2>(const Vec3& place, const Vec3& normal)>;

/// The sides that are outside, of each face (the caller's order).
///
/// One side of a body is its inside, also where the body is open: what stands behind a brick on a
/// wall is hidden, though the inside of the wall is seen from below. So if a patch of consistently
/// oriented faces sees far more of the sky on one side, only that side is outside; which one does
/// not depend on the orientation. Both sides of leaves and flags are outside.
/// \throw Cancelled
[[nodiscard]] std::vector<Sides> outer_sides(const Surface& surface, const FreeOnSides& free,
                                             const Context* context = nullptr);

}  // namespace dapple
