// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/refine.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <limits>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kPlenty = 1'000'000;

EdgeMarks longer_than(double limit, const Piece& piece) {
  EdgeMarks marks{};
  for (std::size_t k = 0; k < 3; ++k)
    marks[k] = (piece.corners[(k + 1) % 3] - piece.corners[k]).norm() > limit;
  return marks;
}

/// Edge lengths that decrease toward a point.
Criterion finer_toward(const Vec3& point, double size) {
  return [=](const Piece& piece) {
    const Vec3 middle = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0;
    return longer_than(std::max(0.02 * size, 0.3 * (middle - point).norm()), piece);
  };
}

/// The length of the edges with `faces` faces; 3 stands for more than two.
double edge_length(const Surface& surface, int with_faces) {
  double sum = 0.0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(3 * surface.face_count()); ++h) {
    if (!surface.ordered().counts(face_of(h))) continue;
    const Face& corners = surface.ordered().corners(face_of(h));
    const auto k = static_cast<std::size_t>(h % 3);
    int faces = 1;
    for (std::int32_t g = surface.ordered().next_around(h); g != h;
         g = surface.ordered().next_around(g))
      ++faces;
    if (std::min(faces, 3) == with_faces)
      sum += (surface.ordered().vertex(corners[k]) - surface.ordered().vertex(corners[(k + 1) % 3]))
                 .norm() /
             faces;
  }
  return sum;
}

/// The smallest angle in radians; 0 for a face without area.
double smallest_angle(const Surface& surface, std::int32_t face) {
  const Face& corners = surface.ordered().corners(surface.ordered().ordered_face(face));
  double smallest = 4.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& apex = surface.ordered().vertex(corners[k]);
    const Vec3 u = surface.ordered().vertex(corners[(k + 1) % 3]) - apex;
    const Vec3 v = surface.ordered().vertex(corners[(k + 2) % 3]) - apex;
    smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
  }
  return smallest;
}

/// Barycentric coordinates in the parent face of a point on a fine face.
Vec3 in_parent(const Refined& refined, std::int32_t face, const Vec3& weights) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    sum += weights[static_cast<Eigen::Index>(k)] *
           refined.barycentric[static_cast<std::size_t>(face)][k];
  return sum;
}

/// Check that every fine face lies where its binding says, on surfaces with these two sets of
/// vertices.
void expect_bound(const Refined& refined, const Surface& coarse, const Surface& fine) {
  const double size = std::sqrt(coarse.area());
  Random random(5);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(fine.face_count()); ++f) {
    const Vec3 weights = random.weights();
    const std::int32_t parent = refined.parents[static_cast<std::size_t>(f)];
    const Vec3 expected = coarse.point(parent, in_parent(refined, f, weights));
    ASSERT_LE((fine.point(f, weights) - expected).norm(), 1e-12 * size) << "face " << f;
  }
}

class RefineOf : public testing::TestWithParam<Shape> {
 protected:
  [[nodiscard]] Refined refined() const {
    const Surface surface = GetParam().surface();
    return refine(surface, finer_toward(focus(surface), std::sqrt(surface.area())), kPlenty);
  }

  static Vec3 focus(const Surface& surface) {
    return surface.ordered().vertex(surface.ordered().corners(nth_face(0))[0]);
  }
};

INSTANTIATE_TEST_SUITE_P(Shapes, RefineOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(RefineOf, CutsUntilNothingIsMarked) {
  const Refined fine = refined();
  const Surface& surface = fine.surface;
  EXPECT_TRUE(fine.resolved);
  EXPECT_GT(surface.face_count(), fine.original.face_count());
  const Criterion criterion = finer_toward(focus(fine.original), std::sqrt(fine.original.area()));
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f) {
    const auto [a, b, c] = surface.ordered().corners(OrderedFace{f});
    if (surface.ordered().geometry(OrderedFace{f}).moments.area > 0.0) {
      ASSERT_EQ(criterion({0,
                           {},
                           {surface.ordered().vertex(a), surface.ordered().vertex(b),
                            surface.ordered().vertex(c)}}),
                EdgeMarks{});
    }
  }
}

TEST_P(RefineOf, KeepsShapeAndDensity) {
  const Refined fine = refined();
  EXPECT_NEAR(fine.surface.area(), fine.original.area(), 1e-12 * fine.original.area());
  EXPECT_NEAR(fine.surface.capacity(), fine.original.capacity(), 1e-12 * fine.original.capacity());
  EXPECT_EQ(fine.surface.uniform(), fine.original.uniform());
  expect_bound(fine, fine.original, fine.surface);
}

/// A vertex in the middle of a neighbor's edge would turn both into border edges.
TEST_P(RefineOf, StaysConforming) {
  const Refined fine = refined();
  EXPECT_NEAR(edge_length(fine.surface, 1), edge_length(fine.original, 1), 1e-9);
  EXPECT_NEAR(edge_length(fine.surface, 3), edge_length(fine.original, 3), 1e-9);
  const Topology before = topology(fine.original), after = topology(fine.surface);
  EXPECT_EQ(after.components, before.components);
  if (!before.manifold) return;
  EXPECT_TRUE(after.manifold);
  EXPECT_EQ(after.border_loops, before.border_loops);
  EXPECT_EQ(after.genus, before.genus);
}

TEST_P(RefineOf, AddsNoVertexThatNoFaceHas) {
  const Refined fine = refined();
  std::vector<bool> used(fine.surface.vertex_count(), false);
  for (const Face& face : fine.surface.faces())
    for (const std::int32_t v : face) used[static_cast<std::size_t>(v)] = true;
  for (std::size_t v = fine.original.vertex_count(); v < used.size(); ++v)
    ASSERT_TRUE(used[v]) << "vertex " << v;
}

TEST_P(RefineOf, NeverMakesAnglesSmallerThanHalf) {
  const Refined fine = refined();
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(fine.surface.face_count()); ++f)
    ASSERT_GE(smallest_angle(fine.surface, f),
              0.499 * smallest_angle(fine.original, fine.parents[static_cast<std::size_t>(f)]))
        << "face " << f;
}

TEST_P(RefineOf, FollowsADeformation) {
  const Refined fine = refined();
  const std::vector<Vec3> moved = deformed(GetParam().vertices, 1.3);
  const Refined carried = fine.deformed(moved);
  EXPECT_TRUE(same_bytes(carried.surface.vertices(), fine.vertices(moved)));
  expect_bound(fine, carried.original, carried.surface);
}

TEST_P(RefineOf, BringsSamplesBack) {
  const Refined fine = refined();
  Random random(7);
  std::vector<std::int32_t> faces, ids;
  std::vector<Vec3> weights;
  for (std::int32_t k = 0; k < 50; ++k) {
    faces.push_back(random.below(static_cast<std::int32_t>(fine.surface.face_count())));
    weights.push_back(random.weights());
    ids.push_back(100 - k);
  }
  const std::vector<std::int32_t> classes(50, 3);
  Samples samples = bind_samples(fine.surface, faces, weights, ids, classes);
  samples.report.energy = 0.25;
  samples.fade = std::vector<double>(50, 0.5);
  const Samples back = to_original(fine, samples);
  EXPECT_EQ(back.ids, ids);
  EXPECT_EQ(back.classes, classes);
  EXPECT_EQ(back.report.energy, 0.25);
  EXPECT_EQ(back.fade, samples.fade);
  const double size = std::sqrt(fine.original.area());
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_LE((back.positions[k] - samples.positions[k]).norm(), 1e-12 * size);
    EXPECT_EQ(back.positions[k], fine.original.point(back.faces[k], back.barycentric[k]));
  }
}

TEST_P(RefineOf, SamplesComeBackFromTheOriginal) {
  const Refined fine = refined();
  Random random(11);
  std::vector<std::int32_t> faces, ids;
  std::vector<Vec3> weights;
  for (std::int32_t k = 0; k < 200; ++k) {
    faces.push_back(random.below(static_cast<std::int32_t>(fine.original.face_count())));
    weights.push_back(k % 4 ? random.weights() : Vec3::Unit(k / 4 % 3));  // corners as well
    ids.push_back(300 - k);
  }
  const Samples samples = bind_samples(fine.original, faces, weights, ids);
  const Samples there = from_original(fine, samples);
  EXPECT_EQ(there.ids, ids);
  const double size = std::sqrt(fine.original.area());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_LE((there.positions[k] - samples.positions[k]).norm(), 1e-12 * size);
    EXPECT_EQ(fine.parents[static_cast<std::size_t>(there.faces[k])], samples.faces[k]);
  }
}

TEST_P(RefineOf, TwiceIsOneRefinement) {
  const Refined first = refined();
  const double size = std::sqrt(first.original.area());
  const Refined second = refine(
      first.surface,
      finer_toward(first.surface.ordered().vertex(first.surface.ordered().corners(nth_face(0))[1]),
                   0.5 * size),
      kPlenty);
  const Refined both = first.then(second);
  expect_bound(both, first.original, second.surface);
  const std::vector<Vec3> moved = deformed(GetParam().vertices, 0.7);
  EXPECT_TRUE(same_bytes(both.vertices(moved), second.vertices(first.vertices(moved))));
}

TEST(Refine, KeepsAwayFromWhereNothingIsMarked) {
  const Surface surface = grid(32).surface();
  const auto criterion = [](const Piece& piece) {
    const bool near = std::any_of(piece.corners.begin(), piece.corners.end(),
                                  [](const Vec3& p) { return p.norm() < 1e-3; });
    return near ? longer_than(1e-3, piece) : EdgeMarks{};
  };
  const Refined fine = refine(surface, criterion, kPlenty);
  EXPECT_LT(fine.surface.face_count(), surface.face_count() + 100);
}

TEST(Refine, ChangesNothingWithoutMarks) {
  const Surface surface = fin(3).surface();
  const Refined same = refine(surface, [](const Piece&) { return EdgeMarks{}; }, kPlenty);
  EXPECT_EQ(same.surface.faces(), surface.faces());
  EXPECT_TRUE(same_bytes(same.surface.vertices(), surface.vertices()));
  EXPECT_TRUE(same.ends.empty());
}

double longest_edge(const Surface& surface, std::int32_t face) {
  const Face& corners = surface.ordered().corners(surface.ordered().ordered_face(face));
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
    longest = std::max(longest, (surface.ordered().vertex(corners[k]) -
                                 surface.ordered().vertex(corners[(k + 1) % 3]))
                                    .norm());
  return longest;
}

TEST(Refine, LeavesNoEdgeLongerThanAsked) {
  const Surface surface = grid(2).surface();
  const std::vector<double> limit = {0.1};
  const Refined fine = refine_edges(surface, limit, kPlenty);
  EXPECT_TRUE(fine.resolved);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(fine.surface.face_count()); ++f)
    EXPECT_LE(longest_edge(fine.surface, f), 0.1);
  EXPECT_LT(fine.surface.face_count(), 2000u);
}

TEST(Refine, CutsEachFaceToItsOwnLength) {
  const Surface surface = grid(8).surface();
  std::vector<double> limits(surface.face_count(), std::numeric_limits<double>::infinity());
  limits[5] = 0.01;
  const Refined fine = refine_edges(surface, limits, kPlenty);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(fine.surface.face_count()); ++f)
    EXPECT_LE(longest_edge(fine.surface, f),
              limits[static_cast<std::size_t>(fine.parents[static_cast<std::size_t>(f)])]);
  EXPECT_LT(fine.surface.face_count(), 2500u);  // the far side is unchanged
}

TEST(Refine, RefusesBadLengths) {
  const Surface surface = grid(2).surface();
  std::vector<double> limits(8, 1.0);
  limits[3] = 0.0;
  expect_message<ArgumentError>([&] { (void)refine_edges(surface, limits, kPlenty); },
                                {"longest[3]", "0"});
  limits.pop_back();
  expect_message<ArgumentError>([&] { (void)refine_edges(surface, limits, kPlenty); },
                                {"longest", "7", "8"});
}

TEST(Refine, StopsAtTheLimitOfFaces) {
  const Surface surface = grid(4).surface();
  const auto all = [](const Piece&) { return EdgeMarks{true, true, true}; };
  for (const std::size_t limit : {1u, 32u, 127u, 128u, 2047u}) {
    const Refined fine = refine(surface, all, limit);
    EXPECT_FALSE(fine.resolved);
    EXPECT_LE(fine.surface.face_count(), std::max<std::size_t>(limit, 32));
    EXPECT_GT(4 * fine.surface.face_count(), limit);
  }
}

TEST(Refine, RefusesBadArguments) {
  const Surface surface = grid(2).surface();
  const auto none = [](const Piece&) { return EdgeMarks{}; };
  for (const std::size_t bad : {std::size_t{0}, std::size_t{200'000'001}})
    expect_message<ArgumentError>([&] { (void)refine(surface, none, bad); },
                                  {"max_faces", std::to_string(bad)});
  const Refined same = refine(surface, none, kPlenty);
  const std::vector<Vec3> five(5, Vec3::Zero());
  expect_message<ArgumentError>([&] { (void)same.vertices(five); }, {"vertices", "5", "9"});
  Samples stray = sample(surface, 3);
  stray.faces[1] = 8;
  expect_message<ArgumentError>([&] { (void)to_original(same, stray); }, {"faces[1]", "8"});
  expect_message<ArgumentError>([&] { (void)from_original(same, stray); }, {"faces[1]", "8"});
  const Refined other = refine(grid(3).surface(), none, kPlenty);
  expect_message<ArgumentError>([&] { (void)same.then(other); }, {"finer", "18", "8"});
}

TEST(Refine, StopsWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW((void)refine(
                   grid(2).surface(), [](const Piece&) { return EdgeMarks{}; }, kPlenty, &context),
               Cancelled);
}

TEST(Refine, JoinsOnlyWhatCutItsOwnSurface) {
  const Refined first = refine_edges(grid(2).surface(), std::vector{0.3}, 10'000);
  const Shape same_faces = {"", first.surface.vertices(), first.surface.faces()};
  const Refined stranger = refine_edges(same_faces.surface(), std::vector{0.2}, 10'000);
  expect_message<ArgumentError>([&] { (void)first.then(stranger); }, {"finer.original"});
  const Surface dense = first.surface.with_density(
      {DensityAt::kVertices, std::vector<double>(first.surface.vertex_count(), 2.0)});
  EXPECT_EQ(first.then(refine_edges(dense, std::vector{0.2}, 10'000)).original.face_count(), 8u);
}

/// A face without area may still be too long.
TEST(Refine, CutsLongFacesWithoutArea) {
  const Surface surface = zero_area_faces().surface();
  const Refined refined = refine_edges(surface, std::vector{0.05}, 100'000);
  ASSERT_TRUE(refined.resolved);
  const std::vector<Vec3> vertices = refined.surface.vertices();
  for (const Face& face : refined.surface.faces())
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE((vertices[static_cast<std::size_t>(face[k])] -
                 vertices[static_cast<std::size_t>(face[(k + 1) % 3])])
                    .norm(),
                0.05);
}

}  // namespace
}  // namespace dapple::test
