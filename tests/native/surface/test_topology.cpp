// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/topology.hpp>

#include "shared_data.hpp"

namespace dapple::test {
namespace {

void expect_closed(const Shape& shape, int components, int genus) {
  const Topology found = topology(shape.surface());
  EXPECT_TRUE(found.manifold) << shape.name;
  EXPECT_TRUE(found.closed) << shape.name;
  EXPECT_EQ(found.components, components) << shape.name;
  EXPECT_EQ(found.genus, genus) << shape.name;
  EXPECT_EQ(found.border_edges, 0) << shape.name;
  EXPECT_EQ(found.border_loops, 0) << shape.name;
  EXPECT_EQ(found.nonmanifold_edges, 0) << shape.name;
}

void expect_open(const Shape& shape, int components, int border_edges, int border_loops,
                 int genus) {
  const Topology found = topology(shape.surface());
  EXPECT_TRUE(found.manifold) << shape.name;
  EXPECT_FALSE(found.closed) << shape.name;
  EXPECT_EQ(found.components, components) << shape.name;
  EXPECT_EQ(found.border_edges, border_edges) << shape.name;
  EXPECT_EQ(found.border_loops, border_loops) << shape.name;
  EXPECT_EQ(found.genus, genus) << shape.name;
}

void expect_not_manifold(const Shape& shape, int components, int border_edges,
                         int nonmanifold_edges) {
  const Topology found = topology(shape.surface());
  EXPECT_FALSE(found.manifold) << shape.name;
  EXPECT_FALSE(found.closed) << shape.name;
  EXPECT_EQ(found.components, components) << shape.name;
  EXPECT_EQ(found.border_edges, border_edges) << shape.name;
  EXPECT_EQ(found.border_loops, -1) << shape.name;
  EXPECT_EQ(found.nonmanifold_edges, nonmanifold_edges) << shape.name;
  EXPECT_EQ(found.genus, -1) << shape.name;
}

TEST(Topology, OfClosedSurfaces) {
  for (const Shape& shape : {tetrahedron(), octahedron(), box(3), icosphere(2), blob(3)})
    expect_closed(shape, 1, 0);
  expect_closed(torus(12, 8), 1, 1);
  expect_closed(two_components(), 2, 0);
  const Shape beside = mapped(torus(9, 7), [](const Vec3& p) { return Vec3(p + Vec3(5, 0, 0)); });
  expect_closed(joined(torus(12, 8), beside), 2, 2);
}

TEST(Topology, OfOpenSurfaces) {
  expect_open(triangle(), 1, 3, 1, 0);
  expect_open(grid(4), 1, 16, 1, 0);
  expect_open(tube(12, 4), 1, 24, 2, 0);
  expect_open(two_sheets(3, 0.1), 2, 24, 2, 0);
  expect_open(many_components(40), 40, 120, 40, 0);
}

/// A torus with a hole still has its handle.
TEST(Topology, OfATorusWithAHole) {
  Shape shape = torus(12, 8);
  shape.faces.pop_back();
  expect_open(shape, 1, 3, 1, 1);
}

TEST(Topology, OfAMoebiusBandIsNotOrientable) {
  const Topology found = topology(moebius(24).surface());
  EXPECT_FALSE(found.manifold);
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(found.border_edges, 48);
  EXPECT_EQ(found.nonmanifold_edges, 0);
}

TEST(Topology, OfFlippedFacesIsNotConsistent) { expect_not_manifold(flipped_faces(), 1, 0, 0); }
TEST(Topology, OfAFin) { expect_not_manifold(fin(4), 1, 36, 4); }
TEST(Topology, OfATee) { expect_not_manifold(tee(2), 1, 28, 4); }
TEST(Topology, OfABowTie) { expect_not_manifold(bow_tie(), 2, 6, 0); }

TEST(Topology, OfIsolatedVerticesCountsFacesOnly) {
  const Topology found = topology(isolated_vertices().surface());
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(found.border_edges, 12);
}

TEST(Topology, OfDuplicateFacesIsThatWithoutThem) {
  const Topology found = topology(duplicate_faces().surface());
  EXPECT_TRUE(found.manifold);
  EXPECT_EQ(found.border_loops, 1);
}

TEST(Topology, OfDuplicateFacesThatAreKeptHasCrowdedEdges) {
  const Shape shape = duplicate_faces();
  const Topology found =
      topology(Surface(shape.vertices, shape.faces, Density{}, {.merge_doubled = false}));
  EXPECT_FALSE(found.manifold);
  EXPECT_GT(found.nonmanifold_edges, 0);
}

TEST(Topology, OfZeroAreaFacesIsMeasured) {
  const Topology found = topology(zero_area_faces().surface());
  EXPECT_FALSE(found.manifold);
  EXPECT_GE(found.components, 1);
}

TEST(Topology, DoesNotDependOnPositions) {
  const Shape shape = tube(12, 4);
  const Topology a = topology(shape.surface());
  const Topology b = topology(shape.surface().deformed(deformed(shape.vertices, 1.0)));
  EXPECT_EQ(a.genus, b.genus);
  EXPECT_EQ(a.border_loops, b.border_loops);
}

TEST(Topology, OfRealMeshes) {
  DAPPLE_NEEDS_MESH("crank");
  const Topology crank = topology(shared_mesh("crank").surface());
  EXPECT_TRUE(crank.closed);
  EXPECT_EQ(crank.genus, 12);
  const Topology truck = topology(shared_mesh("truck").surface());
  EXPECT_FALSE(truck.manifold);
  EXPECT_EQ(truck.nonmanifold_edges, 54);
  EXPECT_EQ(truck.components, 59)
      << "over edges; 50 where parts that meet at a vertex count as one";
  EXPECT_EQ(topology(shared_mesh("lilium").surface()).border_edges, 186);
  EXPECT_TRUE(topology(shared_mesh("bunny").surface()).closed);
  EXPECT_TRUE(topology(shared_mesh("fandisk").surface()).closed);
}

/// Faces that lie on each other are not connected along their common edge (weld.hpp).
TEST(Topology, IsNotClosedWhereFacesOfAFlatSoupStayApart) {
  const Shape flat =
      mapped(icosphere(0), [](const Vec3& p) { return Vec3(p.x(), p.y(), 1e-4 * p.z()); });
  const Topology found = topology(soup(flat).surface());
  EXPECT_EQ(found.border_edges, 4);
  EXPECT_FALSE(found.closed);
}

/// The result reports inconsistent faces; a library does not print.
TEST(Topology, PrintsNothing) {
  testing::internal::CaptureStderr();
  for (const Shape& shape : {fin(3), bow_tie(), duplicate_faces(), moebius(12)})
    (void)topology(shape.surface());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace dapple::test
