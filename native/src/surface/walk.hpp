// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

namespace dapple {

/// Project points that have left the faces `from` (caller's indices) without jumping to another
/// sheet: petals, lips, fingers, the far side of a wall. A point at distance D from its face goes
/// to the nearest point among those connected to that face within the ball of radius D around it.
/// Only faces with density are hit. Unlike a projector this needs no preparation. \throw Cancelled
[[nodiscard]] Projection walk_to_nearest(const Surface& surface, std::span<const Vec3> points,
                                         std::span<const std::int32_t> from,
                                         const Context* context = nullptr);

}  // namespace dapple
