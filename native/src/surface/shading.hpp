// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// The shading of a surface: hard edges and given normals, in the surface's own order. Surfaces
/// deformed from one another share the hard edges.
struct Shading {
  double sharp_angle = 30.0;       ///< see SurfaceOptions
  std::vector<std::uint8_t> hard;  ///< per face, bit k: the edge from corner k on is hard
  std::vector<Vec3> given;         ///< three per face, unit or zero where none is known; or empty
};

}  // namespace dapple
