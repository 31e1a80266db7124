// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>

namespace dapple {

/// The density of the surface at the corners of pieces of its faces; empty if it is uniform.
/// \param refined its parents and barycentric coordinates are read
[[nodiscard]] std::vector<double> carried_density(const Surface& surface, const Refined& refined,
                                                  const Context* context);

/// The normals of the surface at the corners of pieces of its faces.
[[nodiscard]] std::vector<Vec3> carried_normals(const Surface& surface, const Refined& refined,
                                                const Context* context);

}  // namespace dapple
