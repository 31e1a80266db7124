// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_graph.hpp"

namespace dapple {

/// Whose cells touch, of sites in the plane; z is not looked at. Without what touches only outside
/// a frame that holds all sites.
[[nodiscard]] SiteGraph plane_graph(std::span<const Vec3> sites, const Eigen::AlignedBox2d& frame);

/// Whose cells touch, of sites in the unit square of the torus, x and y in [0, 1). With few sites a
/// site touches several images of another, and images of its own.
[[nodiscard]] SiteGraph torus_graph(std::span<const Vec3> sites);

}  // namespace dapple
