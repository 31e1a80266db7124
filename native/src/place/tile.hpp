// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/mosaic.hpp>
#include <functional>

#include "place/patch.hpp"

namespace dapple {

/// The same polygons, apart where they do not form a surface with a disc or half-disc around each
/// vertex: at vertices where parts only touch, and along edges where three or more meet or two are
/// turned against each other.
[[nodiscard]] Patch apart(const Patch& patch);

/// The same with one polygon for each set of polygons in one plane, unless that set has a hole or
/// touches itself, and without vertices in the middle of straight edges, but for those that are to
/// stay.
/// \param stays  of a point, whether it does; null: none does
[[nodiscard]] Patch merged(const Patch& patch,
                           const std::function<bool(const Vec3&)>& stays = nullptr);

/// How a patch, that is apart, hangs together.
struct PatchTopology {
  std::int32_t parts = 0;
  std::int32_t loops = 0;
};
[[nodiscard]] PatchTopology topology_of(const Patch& patch);

/// Twice the area times the normal, of a polygon that may be bent a little.
[[nodiscard]] Vec3 twice_area_vector(const Patch& patch, const PatchPolygon& polygon);

/// A patch with its polygons' sides.
struct TileMesh {
  Patch patch;
  std::vector<TileSide> sides;
};

/// A body on the patch: its top at `thickness` along the normals, walls along its loops, its
/// bottom in the surface; without thickness the patch itself. At creases the top is mitred, to at
/// most twice the thickness.
[[nodiscard]] TileMesh raised(const Patch& patch, double thickness);

}  // namespace dapple
