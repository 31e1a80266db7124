// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <memory>
#include <vector>

namespace dapple {

/// A surface whose walls have two sides.
struct SidedSurface {
  Surface all;
  std::vector<bool> rims;  ///< per ordered face, those that are narrow
  Surface without_rims;    ///< of density 0 there: sites that begin on a rim stay on it
};

/// The surface with the two sides of each wall that is thinner than half a spacing, and wider than
/// that, as components of their own; null where there is no such wall.
///
/// Straight distance goes through a wall. A cell that reaches the rim would go on around it and own
/// what is behind it too, until another site comes between it and the rim: then it loses that all
/// at once. So cells end at the rim, whose narrow faces belong to the nearer side.
/// Faces and vertices are in the same order. A function of the surface and `count` alone.
/// \throw Cancelled
[[nodiscard]] std::shared_ptr<const SidedSurface> with_sides(const Surface& surface,
                                                             std::size_t count,
                                                             Context* context = nullptr);

/// The same sides on a surface made from that one by deformed() or with_density().
[[nodiscard]] std::shared_ptr<const SidedSurface> with_sides_of(const SidedSurface& known,
                                                                const Surface& surface);

}  // namespace dapple
