// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/mosaic.hpp>
#include <functional>

#include "place/patch.hpp"

namespace dapple {

/// The same polygons, separated where they are not manifold: at vertices where parts only touch,
/// and along edges where three or more meet or two have opposite orientation.
[[nodiscard]] Patch apart(const Patch& patch);

/// The same with the polygons of one plane merged into one, unless the result has a hole or touches
/// itself, and without vertices in the middle of straight edges, except those that must stay.
/// \param stays  whether a point must stay; null: none must
[[nodiscard]] Patch merged(const Patch& patch,
                           const std::function<bool(const Vec3&)>& stays = nullptr);

/// The connectivity of a manifold patch.
struct PatchTopology {
  std::int32_t parts = 0;
  std::int32_t loops = 0;
};
[[nodiscard]] PatchTopology topology_of(const Patch& patch);

/// Twice the area times the normal of a polygon that may be slightly bent.
[[nodiscard]] Vec3 twice_area_vector(const Patch& patch, const PatchPolygon& polygon);

/// A patch with its polygons' sides.
struct TileMesh {
  Patch patch;
  std::vector<TileSide> sides;
};

/// A solid on the patch: its top at `thickness` along the normals, walls along its loops, its
/// bottom in the surface; without thickness the patch itself. At creases the top is mitered, to at
/// most twice the thickness.
[[nodiscard]] TileMesh raised(const Patch& patch, double thickness);

}  // namespace dapple
