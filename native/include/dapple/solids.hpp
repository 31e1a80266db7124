// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Convex solids: the convex hulls of points, with all that is not farther from one than a margin.
/// A hull may be flat, a line or a point.
struct Solids {
  std::span<const Vec3> points = {};          ///< of all solids, one after the other
  std::span<const std::int32_t> counts = {};  ///< number of points of each; 0: there is none
  double margin = 0.0;                        ///< >= 0
};

/// How a triangle lies relative to solids.
enum class Reach : std::uint8_t {
  kClear,   ///< it touches none
  kPartly,  ///< it touches at least one
  kInside,  ///< it is inside one
};

/// For each face how it lies relative to the solids. kClear is certain: a plane separates the face
/// from each of them.
/// \throw ArgumentError naming the first coordinate that is not finite, vertex that a face does not
/// have, negative count; if the counts do not sum up to the points or the margin is out of range;
/// Cancelled
[[nodiscard]] std::vector<Reach> reached_by_solids(std::span<const Vec3> vertices,
                                                   std::span<const Face> faces,
                                                   const Solids& solids,
                                                   Context* context = nullptr);

/// All pairs of solids that touch, the smaller index first, in ascending order; each margin counts.
/// \throw ArgumentError as reached_by_solids(); Cancelled
[[nodiscard]] std::vector<std::array<std::int32_t, 2>> touching_solids(const Solids& solids,
                                                                       Context* context = nullptr);

}  // namespace dapple
