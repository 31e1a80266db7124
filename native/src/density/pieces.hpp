// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>

namespace dapple {

/// The edges of a piece that are longer than a limit.
inline EdgeMarks longer_than(double limit, const std::array<Vec3, 3>& t) {
  return {(t[1] - t[0]).norm() > limit, (t[2] - t[1]).norm() > limit, (t[0] - t[2]).norm() > limit};
}

/// Per vertex of a surface the one that stands for its welded group, the caller's indices.
[[nodiscard]] std::vector<std::int32_t> welded_vertices(const Surface& surface);

/// The density of a surface at the corners of its faces, without some of them.
/// \param taken per face, the caller's index: nonzero for no density
/// \return empty if no density is left
[[nodiscard]] std::vector<double> density_without(const Surface& surface,
                                                  std::span<const std::uint8_t> taken);

/// The density of the surface at the corners of pieces of its faces; empty if it is uniform.
/// \param refined its parents and barycentric coordinates are read
[[nodiscard]] std::vector<double> carried_density(const Surface& surface, const Refined& refined,
                                                  const Context* context);

/// Of pieces of a surface's faces, the bodies that they are of (see Joints::bodies); empty for one.
/// \param parents per piece, the caller's index of its face
[[nodiscard]] std::vector<std::int32_t> carried_bodies(const Surface& surface,
                                                       std::span<const std::int32_t> parents);

/// The normals given to a surface, at the corners of pieces of its faces; empty if none are.
[[nodiscard]] std::vector<Vec3> carried_normals(const Surface& surface, const Refined& refined,
                                                const Context* context);

}  // namespace dapple
