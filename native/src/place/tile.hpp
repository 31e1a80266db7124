// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/mosaic.hpp>
#include <vector>

#include "place/patch.hpp"

namespace dapple {

/// The same polygons, separated where they are not manifold: at vertices where parts only touch,
/// and along edges where three or more meet or two have opposite orientation.
[[nodiscard]] Patch apart(const Patch& patch);

/// The connectivity of a manifold patch.
struct PatchTopology {
  std::int32_t parts = 0;
  std::int32_t loops = 0;
};

/// A manifold patch before vertices in the middle of straight edges are removed.
struct FlatPatch {
  Patch patch;
  std::vector<bool> straight;  ///< per point, whether it lies in the middle of straight edges only;
                               ///< empty if none counts as that
  PatchTopology topology;
};

/// The same with the polygons of one plane merged into one, unless the result has a hole or touches
/// itself.
/// \param patch separated, see apart()
/// \param merge whether to merge; otherwise no point counts as straight
[[nodiscard]] FlatPatch flattened(const Patch& patch, bool merge);

/// A polygon without straight vertices; all of its corners if fewer than three would remain.
[[nodiscard]] std::vector<std::int32_t> kept_corners(const FlatPatch& flat,
                                                     const PatchPolygon& polygon);

/// The patch without straight vertices and points that no polygon uses.
[[nodiscard]] Patch without_straight(FlatPatch flat);

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
