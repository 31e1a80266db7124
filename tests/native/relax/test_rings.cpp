// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/restricted_voronoi.hpp>
#include <set>

#include "relax/rings.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

using Indices = std::vector<std::int32_t>;

/// The rings derived from the polygons of all cells.
struct Known {
  explicit Known(const Surface& surface, const Sites& sites)
      : neighbors(sites.size()), faces(sites.size()) {
    for (const CellPolygon& piece :
         restricted_voronoi_polygons(surface, sites, Cells::kEuclidean)) {
      const auto s = static_cast<std::size_t>(piece.site);
      faces[s].insert(surface.ordered().ordered_face(piece.face));
      for (const std::int32_t edge : piece.edges)
        if (edge >= 0) neighbors[s].insert(edge);
    }
  }
  std::vector<std::set<std::int32_t>> neighbors;
  std::vector<std::set<OrderedFace>> faces;
};

TEST(Rings, AreThoseOfTheWholeDiagram) {
  const Shape shape = blob(3);
  const Surface surface = shape.surface();
  Random random(1);
  const Sites sites = random_sites(shape, 200, random);
  const Known known(surface, sites);
  Rings rings(surface, sites);
  for (const std::int32_t first : {0, 50, 199}) {
    std::set<std::int32_t> expected = {first};
    Indices found = {first};
    for (int ring = 0; ring < 3; ++ring) {
      for (const std::int32_t s : Indices(expected.begin(), expected.end()))
        expected.insert(known.neighbors[static_cast<std::size_t>(s)].begin(),
                        known.neighbors[static_cast<std::size_t>(s)].end());
      found = rings.grown(found, nullptr);
      EXPECT_EQ(found, Indices(expected.begin(), expected.end()));
    }
    std::set<OrderedFace> faces;
    for (const std::int32_t s : found)
      faces.insert(known.faces[static_cast<std::size_t>(s)].begin(),
                   known.faces[static_cast<std::size_t>(s)].end());
    EXPECT_EQ(rings.faces(found, nullptr), std::vector<OrderedFace>(faces.begin(), faces.end()));
  }
}

TEST(Rings, OwnersHaveAPartOfAFace) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  Random random(2);
  const Sites sites = random_sites(shape, 300, random);
  const Known known(surface, sites);
  Rings rings(surface, sites);
  std::vector<OrderedFace> faces;
  for (std::size_t f = 3; f < surface.face_count(); f += 17) faces.push_back(nth_face(f));
  Indices expected;
  for (std::size_t s = 0; s < sites.size(); ++s)
    if (std::any_of(faces.begin(), faces.end(),
                    [&](OrderedFace face) { return known.faces[s].contains(face); }))
      expected.push_back(static_cast<std::int32_t>(s));
  EXPECT_EQ(rings.owners(faces, nullptr), expected);
}

}  // namespace
}  // namespace dapple::test
