// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/types.hpp>

namespace dapple {

/// What a site of a remesh may do.
enum class SiteKind : std::int8_t {
  kFree,    ///< it lies within faces
  kLine,    ///< on a line
  kCorner,  ///< at a corner of lines
};

/// A place on the surface, on an edge or within a face.
struct Place {
  Vec3 position = Vec3::Zero();
  std::int32_t face = 0;        ///< the caller's
  std::int32_t half_edge = -1;  ///< the ordered one that it lies on; -1: within the face
};

/// How cells break the closed ball property, by which the dual is a mesh of the same topology; or
/// what else is wrong at a site.
enum class Flaw : std::uint8_t {
  kForeignLine,  ///< the cell reaches a line that its site is not on
  kNoDisc,       ///< the cell is no disc, or meets its line more than once
  kMetTwice,     ///< two cells meet along more than one curve
  kFewSides,     ///< the cell has too few neighbors for triangles
  kUnmatched,    ///< neighbors disagree about where they meet
  kFar,          ///< the mesh and the surface are too far apart
  kAway,         ///< a triangle faces away from the surface
};

struct Violation {
  std::int32_t site;
  Flaw flaw;
  Place place;    ///< where another site mends it
  Place nearest;  ///< kForeignLine: the place of the line nearest to the site
};

}  // namespace dapple
