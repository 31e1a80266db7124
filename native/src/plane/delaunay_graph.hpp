// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_graph.hpp"

namespace dapple {

/// Neighbors in the Delaunay triangulation of sites in the plane; z is not looked at.
[[nodiscard]] SiteGraph plane_graph(std::span<const Vec3> sites);

/// Neighbors in the periodic Delaunay triangulation of sites in the unit square, x and y in
/// [0, 1). With few sites a site touches several images of another, and images of its own.
[[nodiscard]] SiteGraph torus_graph(std::span<const Vec3> sites);

}  // namespace dapple
