// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/domain.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>

#include "density/cut_surface.hpp"
#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

/// A cube of twelve faces with three walls inside that cross each other.
Shape room() {
  Shape shape = box(1);
  for (int axis = 0; axis < 3; ++axis)
    shape = joined(shape, mapped(grid(1), [axis](const Vec3& p) {
                     Vec3 q;
                     q[axis] = 0.5;
                     q[(axis + 1) % 3] = p.x();
                     q[(axis + 2) % 3] = p.y();
                     return q;
                   }));
  shape.name = "Room";
  return shape;
}

TEST(CutSurface, IsNoneWhereNoFaceHoldsManyCells) {
  EXPECT_EQ(cut_for(icosphere(3).surface(), 500), nullptr);
  EXPECT_EQ(cut_for(room().surface(), 20), nullptr);
}

TEST(CutSurface, NoPieceHoldsManyCells) {
  const Surface surface = room().surface();
  const auto cut = cut_for(surface, 8192);
  ASSERT_NE(cut, nullptr);
  for (std::size_t f = 0; f < cut->surface().face_count(); ++f)
    EXPECT_LE(cut->surface().ordered().geometry(nth_face(f)).moments.capacity * 8192,
              24.0 * surface.capacity());
  EXPECT_NEAR(cut->surface().area(), surface.area(), 1e-12 * surface.area());
  EXPECT_EQ(cut->surface().ordered().components(), surface.ordered().components());
}

TEST(CutSurface, PiecesFollowTheDensity) {
  const Surface surface =
      with_density(box(1), [](const Vec3& p) { return p.x() > 0.5 ? 0.0 : 1.0; }).surface();
  const auto cut = cut_for(surface, 1000);
  ASSERT_NE(cut, nullptr);
  EXPECT_NEAR(cut->surface().capacity(), surface.capacity(), 1e-12 * surface.capacity());
}

TEST(CutSurface, SitesLieOnPiecesOfTheirFaces) {
  for (const Shape& shape : {room(), triangle(), soup(box(1)), needle()}) {
    const Surface surface = shape.surface();
    const auto cut = cut_for(surface, 3000);
    ASSERT_NE(cut, nullptr) << shape.name;
    Random random(3);
    const Sites sites = degenerate_sites(shape, 500, random);
    const Sites found = cut->on_pieces(sites);
    for (std::size_t k = 0; k < sites.size(); ++k) {
      EXPECT_EQ(cut->parent(found.faces[k]), sites.faces[k]);
      const Vec3 place = cut->surface().point(found.faces[k], found.barycentric[k]);
      EXPECT_LE((place - sites.positions[k]).norm(), 1e-9 * std::sqrt(surface.area()) + 1e-9)
          << shape.name;
    }
  }
}

TEST(CutSurface, SitesOnFacesThatAreThereTwiceLieOnPiecesOfTheOther) {
  Shape shape = room();
  const auto first = static_cast<std::int32_t>(shape.faces.size());
  for (std::int32_t f = 0; f < first; ++f) {
    const auto [a, b, c] = shape.faces[static_cast<std::size_t>(f)];
    shape.faces.push_back({b, a, c});
  }
  const Surface surface = shape.surface();
  const auto cut = cut_for(surface, 8192);
  ASSERT_NE(cut, nullptr);
  Sites sites;
  const Vec3 weights(0.2, 0.3, 0.5);
  for (std::int32_t f = 0; f < 2 * first; ++f) {
    sites.positions.push_back(surface.point(f, weights));
    sites.faces.push_back(f);
    sites.barycentric.push_back(weights);
  }
  const Sites found = cut->on_pieces(sites);
  for (std::size_t k = 0; k < sites.size(); ++k)
    EXPECT_LT(
        (cut->surface().point(found.faces[k], found.barycentric[k]) - sites.positions[k]).norm(),
        1e-12)
        << k;
}

TEST(CutSurface, CellsOnPiecesAreThoseOnTheWholeFaces) {
  const Shape shape = box(1);
  const Surface surface = shape.surface();
  Random random(5);
  const Sites sites = random_sites(shape, 800, random);
  const RestrictedVoronoi whole = restricted_voronoi(surface, sites, Cells::kEuclidean);
  const RestrictedVoronoi cut = SurfaceDomain(surface, Cells::kEuclidean).cells(sites, nullptr);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    EXPECT_NEAR(cut.cells[k].capacity, whole.cells[k].capacity, 1e-12);
    EXPECT_EQ(cut.boundary(k).size(), whole.boundary(k).size());
  }
}

TEST(CutSurface, AGapThatOpensLaterDoesNotDividePieces) {
  const Shape shape = soup(box(1));
  std::vector<Vec3> torn = shape.vertices;
  for (std::size_t v = 0; v < torn.size(); ++v)
    torn[v] += 1e-3 * Vec3(static_cast<double>(v % 3), static_cast<double>(v % 5), 1.0);
  const auto cut = cut_for(shape.surface().deformed(torn), 2000);
  ASSERT_NE(cut, nullptr);
  EXPECT_EQ(cut->surface().ordered().components(), 1);
}

TEST(CutSurface, ARoomOfLargeFacesIsSampledEvenly) {
  const Surface surface = room().surface();
  const Samples samples = sample(surface, 2000);
  check(surface, samples);
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.02);
  EXPECT_GE(samples.report.evenness.alpha_min, 0.5);
}

TEST(CutSurface, TilesNameTheFacesThatTheyLieOn) {
  const Shape shape = room();
  const Surface surface = shape.surface();
  const Mosaic tiles = mosaic(surface, sample(surface, 600));
  double area = 0.0;
  for (const Tile& tile : tiles.tiles) area += tile.area;
  EXPECT_NEAR(area, surface.area(), 1e-6 * surface.area());
  for (const std::int32_t face : tiles.faces)
    EXPECT_LT(face, static_cast<std::int32_t>(shape.faces.size()));
}

}  // namespace
}  // namespace dapple::test
