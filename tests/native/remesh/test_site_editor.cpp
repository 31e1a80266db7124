// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "remesh/site_editor.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

/// A square whose border has an edge without length.
Surface square_with_a_short_edge() {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
  const std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}, {2, 4, 3}};
  SurfaceOptions plain;
  plain.weld = std::nullopt;
  return Surface(vertices, faces, Density{}, plain);
}

std::int32_t short_edge(const Surface& surface) {
  const OrderedSurface& mesh = surface.ordered();
  for (std::int32_t h = 0; h < 3 * static_cast<std::int32_t>(surface.face_count()); ++h)
    if (mesh.vertex(start_of(mesh, h)) == mesh.vertex(end_of(mesh, h))) return h;
  return -1;
}

TEST(SiteEditor, APlaceOnAnEdgeWithoutLengthIsAtItsEnds) {
  const Surface surface = square_with_a_short_edge();
  const FeatureLines lines(surface, {});
  const std::int32_t edge = short_edge(surface);
  ASSERT_TRUE(lines.is_line(edge));
  RemeshSites sites;
  sites.add({{{0.2, 0.2, 0.0}}, {0}, {{0.8, 0.0, 0.2}}}, SiteKind::kLine, 0, false);
  const Place place = {{1.0, 1.0, 0.0}, 2, edge};
  const Violation violation = {0, Flaw::kForeignLine, place, place};
  ASSERT_EQ(mend(surface, lines, {&violation, 1}, sites), 1u);
  ASSERT_EQ(sites.size(), 2u);
  EXPECT_EQ(sites.sites.positions[1], Vec3(1.0, 1.0, 0.0));
  EXPECT_TRUE(sites.sites.barycentric[1].allFinite());
}

TEST(SiteEditor, NoSecondSiteIsAddedAtAPlaceThatMirrorsAnother) {
  const std::vector<Vec3> vertices = {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}};
  const std::vector<Face> faces = {{0, 1, 2}};
  const Surface surface(vertices, faces);
  const FeatureLines lines(surface, {});
  const OrderedSurface& mesh = surface.ordered();
  const auto edge_to = [&](const Vec3& end) {  // from the first vertex
    for (std::int32_t h = 0; h < 3; ++h) {
      const Vec3 &a = mesh.vertex(start_of(mesh, h)), &b = mesh.vertex(end_of(mesh, h));
      if ((a == vertices[0] && b == end) || (a == end && b == vertices[0])) return h;
    }
    return -1;
  };
  const std::int32_t low = edge_to(vertices[1]), slanted = edge_to(vertices[2]);
  RemeshSites sites;
  const Vec3 here(2, 0, 0), mirrored = 2.0 * Vec3(4, 1, 0).normalized();
  sites.add({{here}, {0}, {{0.5, 0.5, 0.0}}}, SiteKind::kLine, lines.chain_of(low), false);
  sites.add({{mirrored}, {0}, {{1.0 - mirrored[1], 0.0, mirrored[1]}}}, SiteKind::kLine,
            lines.chain_of(slanted), false);
  const Place place = {{2.8, 0.7, 0.0}, 0, slanted};
  const Violation violation = {0, Flaw::kForeignLine, place, place};
  ASSERT_EQ(mend(surface, lines, {&violation, 1}, sites), 1u);
  ASSERT_EQ(sites.size(), 3u);
  EXPECT_LT((sites.sites.positions[2] - place.position).norm(), 1e-12);
}

}  // namespace
}  // namespace dapple::test
