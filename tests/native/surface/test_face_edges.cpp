// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "shapes.hpp"
#include "surface/face_edges.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple::test {
namespace {

FaceEdges edges_of(const Shape& shape) { return FaceEdges(shape.surface().ordered()); }

class FaceEdgesOf : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, FaceEdgesOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(FaceEdgesOf, JoinTheCornersOfEachFace) {
  const FaceEdges edges = edges_of(GetParam());
  for (std::size_t f = 0; f < edges.corners().size(); ++f) {
    const Face& corners = edges.corners()[f];
    const FaceEdges::OfFace& face = edges.of(nth_face(f));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = corners[k], b = corners[(k + 1) % 3];
      const FaceEdges::Ends ends = edges.edges(f / FaceEdges::kFaces)[face.edges[k]];
      EXPECT_EQ(ends, (FaceEdges::Ends{std::min(a, b), std::max(a, b)}));
      EXPECT_EQ((face.upward >> k & 1) != 0, a < b);
    }
  }
}

TEST_P(FaceEdgesOf, OccurOnceInAChunk) {
  const FaceEdges edges = edges_of(GetParam());
  for (std::size_t chunk = 0; chunk < edges.chunks(); ++chunk) {
    const auto all = edges.edges(chunk);
    EXPECT_EQ(std::set(all.begin(), all.end()).size(), all.size());
  }
}

/// Each vertex belongs to one component.
TEST_P(FaceEdgesOf, CopyVerticesThatComponentsShare) {
  const Surface surface = GetParam().surface();
  const OrderedSurface& mesh = surface.ordered();
  const FaceEdges edges(mesh);
  std::vector<std::int32_t> component(edges.vertex_count(), -1);
  for (std::size_t f = 0; f < edges.corners().size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(edges.corners()[f][k]);
      if (component[v] < 0) component[v] = mesh.component(nth_face(f));
      EXPECT_EQ(component[v], mesh.component(nth_face(f)));
      const std::int32_t place =
          v < mesh.vertex_count() ? edges.corners()[f][k] : edges.copied()[v - mesh.vertex_count()];
      EXPECT_EQ(place, mesh.corners(nth_face(f))[k]);
    }
}

TEST(FaceEdges, KnowVerticesThatPinchTheSurface) {
  EXPECT_TRUE(edges_of(icosphere(2)).pinched().empty());
  EXPECT_TRUE(edges_of(grid(4)).pinched().empty());
  // Two fans of one component around the middle vertex, joined by a face far from it.
  const Shape pinched{"Pinched",
                      {{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 3, 0}},
                      {{0, 1, 2}, {0, 3, 4}, {2, 5, 1}, {3, 5, 2}, {4, 3, 5}}};
  EXPECT_EQ(edges_of(pinched).pinched().size() > 0, true);
}

}  // namespace
}  // namespace dapple::test
