// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/projector.hpp>
#include <set>

#include "remesh/measure.hpp"
#include "remesh/polish.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

/// A site of a surface in the plane, at a corner or on the line that it is nearest to.
void add(const Surface& surface, const FeatureLines& lines, const Vec3& place, SiteKind kind,
         RemeshSites& sites) {
  std::int32_t chain = -1;
  for (std::size_t k = 0; k < lines.chains().size() && kind == SiteKind::kLine; ++k) {
    const LineChain& along = lines.chains()[k];
    const Vec3 a = surface.ordered().vertex(along.vertices.front()),
               b = surface.ordered().vertex(along.vertices.back());
    if ((b - a).cross(place - a).norm() < 1e-9) chain = static_cast<std::int32_t>(k);
  }
  Projection found = Projector(surface).project(std::vector<Vec3>{place});
  sites.add({found.positions, found.faces, found.barycentric}, kind, chain, false);
}

double smallest_angle_of(const RemeshSites& sites, const Dual& dual) {
  double least = 180.0;
  for (const auto& [a, b, c] : dual.triangles)
    least = std::min(least, smallest_angle(sites.sites.positions[as_index(a)],
                                           sites.sites.positions[as_index(b)],
                                           sites.sites.positions[as_index(c)]));
  return least;
}

/// A square with two vertices side by side on its border.
struct SquareWithANeedle {
  Surface surface = grid(4).surface();
  FeatureLines lines{surface, {}};
  RemeshSites sites;
  Dual dual;

  SquareWithANeedle() {
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)})
      add(surface, lines, corner, SiteKind::kCorner, sites);
    add(surface, lines, {0.5, 0.0, 0.0}, SiteKind::kLine, sites);
    add(surface, lines, {0.52, 0.0, 0.0}, SiteKind::kLine, sites);
    add(surface, lines, {0.5, 0.5, 0.0}, SiteKind::kFree, sites);
    dual.triangles = {{6, 0, 4}, {6, 4, 5}, {6, 5, 1}, {6, 1, 2}, {6, 2, 3}, {6, 3, 0}};
    dual.lines = {{0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {4, 5}};
  }

  [[nodiscard]] std::set<std::int32_t> used() const {
    std::set<std::int32_t> result;
    for (const Face& t : dual.triangles) result.insert(t.begin(), t.end());
    return result;
  }
};

TEST(Polish, MovesAVertexOfALineAwayFromItsNeighbor) {
  SquareWithANeedle made;
  ASSERT_LT(smallest_angle_of(made.sites, made.dual), 3.0);
  polish(made.surface, made.lines, 7, made.sites, made.dual);
  EXPECT_GT(smallest_angle_of(made.sites, made.dual), 20.0);
  EXPECT_EQ(made.used().size(), 7u);
  for (const auto& [a, b] : made.dual.lines) {
    const Vec3 along =
        made.sites.sites.positions[as_index(b)] - made.sites.sites.positions[as_index(a)];
    EXPECT_NEAR(along.cwiseAbs().minCoeff(), 0.0, 1e-12);
    EXPECT_NEAR(along.head<2>().cwiseAbs().minCoeff(), 0.0, 1e-12);
  }
}

TEST(Polish, KeepsAGoodMesh) {
  SquareWithANeedle made;
  made.dual.triangles = {{6, 0, 4}, {6, 4, 1}, {6, 1, 2}, {6, 2, 3}, {6, 3, 0}};
  made.dual.lines = {{0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}};
  const std::vector<Vec3> before = made.sites.sites.positions;
  const std::vector<Face> triangles = made.dual.triangles;
  polish(made.surface, made.lines, 6, made.sites, made.dual);
  EXPECT_EQ(made.dual.triangles, triangles);
  EXPECT_EQ(made.sites.sites.positions, before);
}

}  // namespace
}  // namespace dapple::test
