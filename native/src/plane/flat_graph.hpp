// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_graph.hpp"

namespace dapple {

/// The graph of touching cells of sites in the plane; z is ignored. Cells that touch only outside a
/// frame that contains all sites are not linked.
[[nodiscard]] SiteGraph plane_graph(std::span<const Vec3> sites, const Eigen::AlignedBox2d& frame);

/// The graph of touching cells of sites in the unit square of the torus, x and y in [0, 1). With
/// few sites a site touches several images of another, and images of itself.
[[nodiscard]] SiteGraph torus_graph(std::span<const Vec3> sites);

}  // namespace dapple
