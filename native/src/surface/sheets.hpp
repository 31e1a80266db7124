// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <vector>

namespace dapple {

/// Components in which no two sheets lie beside each other that meet at an edge of three or more
/// faces: a second shell with some faces of the first, a fin at a small angle to its ground. As far
/// as they are near each other, straight distance does not tell which of the two a site is on, so
/// that cells beside the edge own pieces of the other sheet or do not. Of such sheets only one is
/// connected to what they both continue.
/// \param cells number of cells of the surface; sheets of a few stay connected
/// \return per ordered face; empty if the surface's components do not change
[[nodiscard]] std::vector<std::int32_t> components_of_sheets(const Surface& surface, double cells,
                                                             const Context* context);

}  // namespace dapple
