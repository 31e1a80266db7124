// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>
#include <span>
#include <vector>

#include "lines/feature_lines.hpp"

namespace dapple {

/// The smallest angle of a triangle, in degrees; 0 for one without extent.
[[nodiscard]] double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Write angles, valences and topology of the mesh into its report.
/// \param lines tell which faces of the surface are turned over in the mesh
void measure_mesh(const Surface& surface, const FeatureLines& lines, RemeshResult& mesh);

/// The triangles that face away from all faces that their corners touch.
[[nodiscard]] std::vector<std::size_t> facing_away(const Surface& surface,
                                                   const FeatureLines& lines,
                                                   std::span<const Face> triangles,
                                                   const Sites& vertices);

}  // namespace dapple
