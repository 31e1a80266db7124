// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "remesh/mesh_editor.hpp"

namespace dapple::test {
namespace {

RemeshSites sites_of(const std::vector<SiteKind>& kinds) {
  RemeshSites sites;
  for (const SiteKind kind : kinds)
    sites.add({{Vec3::Zero()}, {0}, {Vec3(1.0, 0.0, 0.0)}}, kind, -1, false);
  return sites;
}

constexpr SiteKind kF = SiteKind::kFree, kL = SiteKind::kLine, kC = SiteKind::kCorner;

/// Six triangles around vertex 0.
const std::vector<Face> kFan = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 1}};

TEST(MeshEditor, FlipsAnEdgeThatIsNoLine) {
  const RemeshSites sites = sites_of({kC, kC, kC, kC});
  const std::vector<Face> square = {{0, 1, 2}, {0, 2, 3}};
  MeshEditor mesh(sites, square, {});
  mesh.apply(mesh.flipped(0, 2));
  EXPECT_EQ(mesh.triangles(), (std::vector<Face>{{0, 1, 3}, {1, 2, 3}}));
  const std::vector<std::array<std::int32_t, 2>> diagonal = {{0, 2}};
  EXPECT_TRUE(MeshEditor(sites, square, diagonal).flipped(0, 2).gone.empty());
}

TEST(MeshEditor, FlipsNoEdgeOfATetrahedron) {
  const RemeshSites sites = sites_of({kF, kF, kF, kF});
  const std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  const MeshEditor mesh(sites, faces, {});
  EXPECT_TRUE(mesh.flipped(0, 1).gone.empty());
  EXPECT_TRUE(mesh.collapsed(0, 1).gone.empty());
}

TEST(MeshEditor, CollapsesAnEdge) {
  const RemeshSites sites = sites_of({kF, kC, kC, kC, kC, kC, kC});
  MeshEditor mesh(sites, kFan, {});
  mesh.collapse(mesh.collapsed(0, 1), 0, 1);
  EXPECT_EQ(mesh.triangles().size(), 4u);
  EXPECT_TRUE(mesh.around(0).empty());
  EXPECT_TRUE(mesh.collapsed(1, 2).gone.empty()) << "a corner";
}

TEST(MeshEditor, AVertexOfALineCollapsesAlongItAlone) {
  const RemeshSites sites = sites_of({kL, kL, kC, kC, kL, kC, kC});
  const std::vector<std::array<std::int32_t, 2>> lines = {{0, 1}, {0, 4}};
  MeshEditor mesh(sites, kFan, lines);
  EXPECT_TRUE(mesh.collapsed(0, 2).gone.empty());
  const MeshChange change = mesh.collapsed(0, 1);
  EXPECT_EQ(change.made_sheets, (std::vector<std::int32_t>{0, 0, 1, 1}));
  mesh.collapse(change, 0, 1);
  EXPECT_EQ(mesh.lines(), (std::vector<std::array<std::int32_t, 2>>{{1, 4}}));
}

TEST(MeshEditor, ARingOfThreeEdgesStays) {
  const RemeshSites sites = sites_of({kF, kF, kF, kF, kF, kF});
  const std::vector<Face> tube = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  const MeshEditor mesh(sites, tube, {});
  EXPECT_TRUE(mesh.collapsed(0, 1).gone.empty());
}

TEST(MeshEditor, NothingChangesAtAnEdgeOfThreeTriangles) {
  const RemeshSites sites = sites_of({kF, kF, kF, kF, kF});
  const std::vector<Face> faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const MeshEditor mesh(sites, faces, {});
  EXPECT_TRUE(mesh.flipped(0, 1).gone.empty());
  EXPECT_TRUE(mesh.collapsed(0, 1).gone.empty());
  EXPECT_TRUE(mesh.split(0, 1, 5).gone.empty());
  EXPECT_TRUE(mesh.moved(0).gone.empty());
}

TEST(MeshEditor, SplitsAnEdge) {
  RemeshSites sites = sites_of({kC, kC, kC, kC});
  MeshEditor mesh(sites, std::vector<Face>{{0, 1, 2}, {0, 2, 3}}, {});
  const MeshChange change = mesh.split(0, 2, 4);
  sites.add({{Vec3::Zero()}, {0}, {Vec3(1.0, 0.0, 0.0)}}, SiteKind::kFree, -1, false);
  mesh.apply(change);
  EXPECT_EQ(mesh.triangles().size(), 4u);
  EXPECT_EQ(mesh.moved(4).gone.size(), 4u);
}

}  // namespace
}  // namespace dapple::test
