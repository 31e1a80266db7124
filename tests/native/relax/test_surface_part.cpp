// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/restricted_voronoi.hpp>

#include "relax/rings.hpp"
#include "relax/surface_part.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

using Indices = std::vector<std::int32_t>;

class SurfacePartOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, SurfacePartOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

/// Cells that have two rings around them on the part equal those on the whole surface.
TEST_P(SurfacePartOf, HasTheSameCellsInside) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  Random random(3);
  const Sites sites = random_sites(shape, 80, random);
  const RestrictedVoronoi whole = restricted_voronoi(surface, sites, Cells::kConnected);
  Rings rings(surface, sites);
  const Indices inner = {0};
  const Indices around = rings.grown(rings.grown(inner, nullptr), nullptr);
  const SurfacePart part(surface, without_holes(surface, rings.faces(around, nullptr), 256),
                         nullptr);
  Sites there;
  std::ptrdiff_t place = -1;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const std::int32_t face = part.inside(sites.faces[s]);
    if (face < 0) continue;
    EXPECT_EQ(part.outside(face), sites.faces[s]);
    if (s == 0) place = static_cast<std::ptrdiff_t>(there.size());
    there.positions.push_back(sites.positions[s]);
    there.faces.push_back(face);
  }
  ASSERT_GE(place, 0);
  const RestrictedVoronoi cut = restricted_voronoi(part.surface(), there, Cells::kConnected);
  const Moments& found = cut.cells[static_cast<std::size_t>(place)];
  EXPECT_NEAR(found.capacity, whole.cells[0].capacity, 1e-12 * surface.capacity());
  EXPECT_NEAR(found.area, whole.cells[0].area, 1e-12 * surface.area());
}

TEST(SurfacePart, KeepsConnectedFaces) {
  const Shape shape = soup(icosphere(2));  // no face shares vertices with another
  const Surface surface = shape.surface();
  std::vector<OrderedFace> faces;
  for (std::size_t f = 0; f < surface.face_count(); ++f) faces.push_back(nth_face(f));
  const SurfacePart all(surface, faces, nullptr);
  EXPECT_EQ(all.surface().ordered().components(), 1);
  EXPECT_EQ(all.surface().face_count(), surface.face_count());
  EXPECT_DOUBLE_EQ(all.surface().area(), surface.area());
}

TEST(WithoutHoles, FillsEnclosedHoles) {
  const Surface surface = icosphere(4).surface();
  std::vector<OrderedFace> ring, filled;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const double z = surface.ordered().geometry(nth_face(f)).centroid.z();
    if (z > 0.7) filled.push_back(nth_face(f));
    if (z > 0.7 && z < 0.9) ring.push_back(nth_face(f));
  }
  ASSERT_LT(ring.size() + 50, filled.size());
  EXPECT_EQ(without_holes(surface, ring, 400), filled);
  EXPECT_EQ(without_holes(surface, ring, 20), ring) << "too large to be a hole";
}

}  // namespace
}  // namespace dapple::test
