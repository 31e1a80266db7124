// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

#include "optimize/mirror.hpp"

namespace dapple {

/// A surface whose density is symmetric.
struct SymmetricGround {
  Surface surface;
  double farthest = 0.0;  ///< images of its points may be so far from it: see Mirror
};

/// Check that a surface is nearly its own mirror image where it has density, and give each place
/// the mean of its density and that of its image. Where they are equal, the surface stays as it is.
/// \param most relative to the size of the part with density, see SymmetryOptions
/// \throw ArgumentError naming the first vertex whose image is farther from the surface; Cancelled
[[nodiscard]] SymmetricGround symmetric_ground(const Surface& surface, const Mirror& mirror,
                                               double most, const Context* context);

}  // namespace dapple
