// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <map>

#include "shapes.hpp"

namespace dapple::test {

/// A cell of the oracle, with the sums over its boundary with each other site.
struct BruteCell {
  Moments moments;  // relative to the site
  std::map<std::int32_t, Vec3> flux;
  std::map<std::int32_t, double> length;
};

/// Cut every face by every bisector in O(faces sites^2), without culling and without code of the
/// library. The first of coincident sites gets the whole cell.
[[nodiscard]] std::vector<BruteCell> brute_force_cells(const Shape& shape,
                                                       const std::vector<Vec3>& sites);

/// The closest point of one triangle (Ericson, Real-Time Collision Detection, 5.1.5).
[[nodiscard]] Vec3 closest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b,
                                       const Vec3& c);

}  // namespace dapple::test
