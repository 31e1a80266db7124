// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/poisson_start.hpp>
#include <set>

#include "shapes.hpp"
#include "voronoi/cell_flood.hpp"

namespace dapple::test {
namespace {

/// The bisectors and faces that the floods of all cells visit.
struct Known {
  std::size_t most = 0;   // of one cell
  std::size_t faces = 0;  // with a part of a cell, summed over all cells
};

Known known_by_floods(const Surface& surface, const OrderedSites& sites) {
  const SiteIndex index(sites);
  CellFlood flood(surface, sites, index);
  Known result;
  for (std::int32_t site = 0; site < static_cast<std::int32_t>(sites.size()); ++site) {
    flood.reset(site);
    const std::vector<OrderedFace> seeds = {sites.faces[static_cast<std::size_t>(site)]};
    flood.flood(seeds, [&](OrderedFace, bool) { ++result.faces; });
    result.most = std::max(result.most, flood.known());
  }
  return result;
}

/// All sites lie on a tenth of a sphere: cells at the rim extend to the other side, but only some
/// dozens of sites cut them.
TEST(Bisectors, OfALongCellAreFew) {
  const Shape shape = with_face_density(icosphere(4), [](const Vec3& x) { return x.z() > 0.8; });
  const Surface surface = shape.surface();
  const OrderedSites sites(surface, poisson_start(surface, 2000, 1));
  const Known known = known_by_floods(surface, sites);
  EXPECT_LT(known.most, 100u);
  EXPECT_GE(known.faces, shape.faces.size());
}

/// The sites lie near the center of a sphere or outside it, where all sites have similar distances
/// to a face.
TEST(Bisectors, OfSitesOffTheSurfaceAreFew) {
  const Surface surface = icosphere(4).surface();
  for (const double radius : {1e-3, 0.3, 5.0}) {
    Sites sites = poisson_start(surface, 2000, 1);
    for (Vec3& x : sites.positions) x *= radius;
    EXPECT_LT(known_by_floods(surface, OrderedSites(surface, sites)).most, 100u) << radius;
  }
}

/// A small component without a site, inside a body or far beside it.
TEST(Bisectors, OfAFarFaceAreThoseOfItsOwners) {
  for (const Vec3& place : {Vec3(0.1, 0.2, 0), Vec3(3, 1, 0), Vec3(1e6, 0, 0)}) {
    const Shape speck =
        mapped(tetrahedron(), [&](const Vec3& x) { return Vec3(1e-3 * x + place); });
    const Surface surface = joined(icosphere(4), speck).surface();
    const OrderedSites sites(surface, poisson_start(icosphere(4).surface(), 2000, 1));
    const SiteIndex index(sites);
    CellFlood flood(surface, sites, index);
    const OrderedFace face =
        surface.ordered().ordered_face(static_cast<std::int32_t>(surface.face_count() - 1));
    const std::int32_t nearest = index.nearest(surface.ordered().geometry(face).centroid, 0);
    flood.reset_far(nearest);
    flood.clip(face);
    EXPECT_FALSE(flood.polygon().empty());
    EXPECT_LE(flood.known(), 20u);
  }
}

}  // namespace
}  // namespace dapple::test
