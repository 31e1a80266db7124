// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// The half-edge of the face that lies on the side of `h`, beyond needles: faces so narrow that
/// their normals mean nothing. A crease along a needle is on its longest edge alone: -1 at the
/// others.
[[nodiscard]] std::int32_t beside_needles(const OrderedSurface& mesh, std::int32_t h, double scale);

}  // namespace dapple
