// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/exposure.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "invariants.hpp"
#include "mesh_area.hpp"
#include "shapes.hpp"
#include "skin/crossings.hpp"
#include "skin/cut_at_crossings.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kShift = 1.1;  // of the second ball

Shape shifted(const Shape& shape, const Vec3& offset, double scale = 1.0) {
  return mapped(shape, [&](const Vec3& p) { return Vec3(scale * p + offset); });
}

/// Two unit balls stuck into each other.
Shape two_balls(int subdivisions = 3) {
  const Shape ball = icosphere(subdivisions);
  return joined(ball, shifted(ball, {kShift, 0.1, 0.05}));
}

Vec3 center_of(const Surface& surface, std::int32_t face) {
  return surface.point(face, Vec3::Constant(1.0 / 3.0));
}

/// Whether a place is clearly within the other ball than the one that it is on.
bool is_inside(const Vec3& place, double slack) {
  const Vec3 second(kShift, 0.1, 0.05);
  return std::min(place.norm(), (place - second).norm()) < 1.0 - slack;
}

TEST(Exposure, IsOneOnConvexBodies) {
  for (const double share : exposure(box(3).surface())) EXPECT_EQ(share, 1.0);
}

TEST(Exposure, IsZeroInsideOfOtherParts) {
  const Shape outer = box(2), inner = shifted(box(2), Vec3::Constant(0.3), 0.4);
  const std::vector<double> found = exposure(joined(outer, inner).surface());
  for (std::size_t f = 0; f < found.size(); ++f)
    EXPECT_EQ(found[f], f < outer.faces.size() ? 1.0 : 0.0) << f;
}

TEST(Exposure, DoesNotDependOnTheOrientation) {
  Shape shape = two_balls(1);
  const std::vector<double> before = exposure(shape.surface());
  for (std::size_t f = 0; f < shape.faces.size(); f += 2)
    std::swap(shape.faces[f][0], shape.faces[f][1]);
  EXPECT_EQ(exposure(shape.surface()), before);
}

TEST(Exposure, OfACornerBetweenWallsIsAbout) {
  // At the foot of a high wall half of the sky is free.
  const Surface surface = tee(8).surface();
  const std::vector<std::int32_t> faces = {0};
  const std::vector<Vec3> weights = {Vec3::Constant(1.0 / 3.0)};
  const double share = exposure(surface, faces, weights)[0];
  EXPECT_GT(share, 0.5);
  EXPECT_LE(share, 1.0);
}

TEST(Exposure, CountsTheFirstOfFacesThatLieOnEachOther) {
  // Not the same corners, so that they are not merged as doubled.
  const Shape below = grid(1), above = shifted(grid(3), {0.0, 0.0, 0.0});
  const std::vector<double> found = exposure(joined(below, above).surface());
  for (std::size_t f = 0; f < found.size(); ++f)
    EXPECT_EQ(found[f], f < below.faces.size() ? 1.0 : 0.0) << f;
}

/// The same square twice, cut along its two diagonals.
Shape square_cut_twice() {
  return {"Square",
          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
}

TEST(Exposure, CountsTheFirstOfFacesOnEachOtherThatShareCorners) {
  EXPECT_EQ(exposure(square_cut_twice().surface()), (std::vector<double>{1, 1, 0, 0}));
}

TEST(Exposure, NamesWhatIsWrong) {
  const Surface surface = box(1).surface();
  const std::vector<std::int32_t> faces = {0, 99};
  const std::vector<Vec3> weights(2, Vec3::UnitX());
  expect_message<ArgumentError>([&] { (void)exposure(surface, faces, weights); },
                                {"faces[1]", "99"});
  expect_message<ArgumentError>([&] { (void)exposure(surface, {&faces[0], 1}, weights); },
                                {"barycentric"});
}

TEST(Crossings, AreTheSameSeenFromBothFaces) {
  const Surface surface = two_balls(2).surface();
  const Crossings found = find_crossings(surface);
  ASSERT_FALSE(found.lines.empty());
  // Each line is in two faces, and both of its ends are on edges of one of them.
  EXPECT_EQ(found.lines.size() % 2, 0U);
  for (const Crossing& point : found.points) {
    const OrderedSurface& mesh = surface.ordered();
    const Vec3 normal = mesh.geometry(point.face).normal;
    const Vec3& corner = mesh.vertex(mesh.corners(point.face)[0]);
    EXPECT_NEAR((point.position - corner).dot(normal), 0.0, 1e-12);
  }
}

TEST(Crossings, AreNoneBetweenPartsThatTouch) {
  const Shape one = box(2);
  EXPECT_TRUE(find_crossings(joined(one, shifted(one, {1.0, 0.0, 0.0})).surface()).lines.empty());
}

TEST(CutAtCrossings, KeepsTheShapeAndConnectsTheParts) {
  const Shape shape = two_balls(2);
  const Surface surface = shape.surface();
  const Refined cut = cut_at_crossings(surface);
  EXPECT_GT(cut.parents.size(), surface.face_count());
  EXPECT_NEAR(cut.surface.area(), surface.area(), 1e-9 * surface.area());
  EXPECT_EQ(surface.ordered().components(), 2);
  EXPECT_EQ(cut.surface.ordered().components(), 1);
  for (std::size_t f = 0; f < cut.parents.size(); ++f)
    for (const Vec3& weights : cut.barycentric[f]) {
      EXPECT_GE(weights.minCoeff(), 0.0);
      EXPECT_NEAR(weights.sum(), 1.0, 1e-12);
    }
}

TEST(CutAtCrossings, TellsTheBodiesApart) {
  const Surface surface = two_balls(2).surface();
  const Refined cut = cut_at_crossings(surface);
  const Refined again = cut.then(refine_edges(cut.surface, std::vector{0.1}, 1'000'000));
  for (const Refined& refined : {cut, again}) {
    const OrderedSurface& mesh = refined.surface.ordered();
    const auto of_one = static_cast<std::int32_t>(surface.face_count() / 2);
    const std::int32_t first = mesh.body(mesh.ordered_face(0));
    for (std::size_t f = 0; f < refined.parents.size(); ++f) {
      const std::int32_t body = mesh.body(mesh.ordered_face(static_cast<std::int32_t>(f)));
      ASSERT_EQ(body == first, refined.parents[f] < of_one) << f;
    }
  }
  const Refined alone = cut_at_crossings(icosphere(2).surface());
  EXPECT_TRUE(alone.surface.ordered().connectivity().body.empty());
}

TEST(CutAtCrossings, LeavesPartsTheirOwnWhenTheyMoveApart) {
  const Shape ball = icosphere(2);
  const Shape shape = two_balls(2);
  const Refined cut = cut_at_crossings(shape.surface());
  std::vector<Vec3> moved = shape.vertices;
  for (std::size_t v = ball.vertices.size(); v < moved.size(); ++v) moved[v] += Vec3(5.0, 0.0, 0.0);
  const Refined apart = cut.deformed(moved);
  EXPECT_NEAR(apart.surface.area(), cut.surface.area(), 1e-9 * cut.surface.area());
}

TEST(CutAtCrossings, ChangesNothingWhereNothingCrosses) {
  const Surface surface = torus(12, 8).surface();
  const Refined cut = cut_at_crossings(surface);
  EXPECT_EQ(cut.surface.vertices(), surface.vertices());
  EXPECT_EQ(cut.surface.faces(), surface.faces());
}

TEST(CutAtCrossings, CutsAFaceThatSeveralOthersCross) {
  // A large triangle with two tetrahedra stuck through it, whose outlines in it cross.
  Shape shape = mapped(grid(1), [](const Vec3& p) { return Vec3(4.0 * p - Vec3(2.0, 2.0, 0.0)); });
  shape = joined(shape, shifted(tetrahedron(), {0.1, 0.05, -0.3}));
  shape = joined(shape, shifted(tetrahedron(), {-0.2, 0.11, -0.25}));
  const Surface surface = shape.surface();
  const Refined cut = cut_at_crossings(surface);
  EXPECT_NEAR(cut.surface.area(), surface.area(), 1e-9 * surface.area());
  EXPECT_EQ(cut.surface.ordered().components(), 1);
}

TEST(RefineOutside, LeavesTheOuterSkin) {
  const Surface surface = two_balls().surface();
  const Refined refined = refine_outside(surface, {.edge = 0.03});
  EXPECT_TRUE(refined.resolved);
  // Each ball loses a cap of height 1 - d / 2, where d is the distance of the centers.
  const double d = Vec3(kShift, 0.1, 0.05).norm();
  const double caps = 4.0 * std::numbers::pi * (1.0 - d / 2.0);
  EXPECT_NEAR(refined.surface.capacity(), surface.area() - caps, 0.01 * surface.area());
  const std::vector<double> density = refined.surface.density();
  for (std::size_t f = 0; f < refined.parents.size(); ++f)
    if (is_inside(center_of(refined.surface, static_cast<std::int32_t>(f)), 0.01)) {
      EXPECT_EQ(density[3 * f], 0.0) << f;
    }
}

TEST(RefineOutside, KeepsSamplesApartAcrossTheJoint) {
  const Surface surface = two_balls().surface();
  constexpr std::size_t kCount = 600;
  const Refined refined = refine_outside(surface, {.edge = 0.1 * surface.spacing(kCount)});
  const Samples fine = sample(refined.surface, kCount);
  const Samples samples = to_original(refined, fine);
  EXPECT_LT(fine.report.evenness.capacity_variation, 0.02);
  const double spacing = refined.surface.spacing(kCount);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_FALSE(is_inside(samples.positions[i], 0.01)) << i;
    for (std::size_t k = 0; k < i; ++k)
      ASSERT_GT((samples.positions[i] - samples.positions[k]).norm(), 0.5 * spacing)
          << i << " " << k;
  }
  const std::vector<double> seen = exposure(surface, samples.faces, samples.barycentric);
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 0.0);
}

TEST(RefineOutside, LeavesOutCrevicesIfAsked) {
  const Surface surface = two_balls().surface();
  const auto left = [&](double openness) {
    return refine_outside(surface, {.openness = openness, .edge = 0.1}).surface.capacity();
  };
  EXPECT_LT(left(0.9), left(0.0));
}

TEST(RefineOutside, KeepsTheDensityOfTheSurface) {
  const Shape shape = with_density(two_balls(2), [](const Vec3& p) { return 2.0 + p.x(); });
  const Refined refined = refine_outside(shape.surface(), {.edge = 0.1});
  const std::vector<double> density = refined.surface.density();
  for (std::size_t f = 0; f < refined.parents.size(); ++f) {
    const Vec3 place = refined.surface.point(static_cast<std::int32_t>(f), Vec3::UnitX());
    if (density[3 * f] > 0.0) {
      EXPECT_NEAR(density[3 * f], 2.0 + place.x(), 1e-9);
    }
  }
}

TEST(RefineOutside, NamesWhatIsWrong) {
  const Surface surface = box(1).surface();
  const auto refused = [&](const OutsideOptions& options, const std::string& part) {
    expect_message<ArgumentError>([&] { (void)refine_outside(surface, options); }, {part});
  };
  refused({.openness = -0.1, .edge = 0.1}, "openness is -0.1");
  refused({.openness = 1.5, .edge = 0.1}, "openness is 1.5");
  refused({.openness = 0.1}, "edge is 0");
  const Shape inner = shifted(box(1), Vec3::Constant(0.3), 0.4);
  const Shape hidden = with_density(joined(box(1), inner), [](const Vec3& p) {
    return (p - Vec3::Constant(0.5)).norm() < 0.5 ? 1.0 : 0.0;
  });
  expect_message<ArgumentError>([&] { (void)refine_outside(hidden.surface(), {.edge = 0.1}); },
                                {"nothing of the surface"});
}

/// Two balls, the second of which is elsewhere.
std::vector<Vec3> with_second_moved(const Shape& shape, const Vec3& offset) {
  std::vector<Vec3> moved = shape.vertices;
  for (std::size_t v = moved.size() / 2; v < moved.size(); ++v) moved[v] += offset;
  return moved;
}

TEST(RefineOutside, LeavesWhatIsSeenInEveryPose) {
  const Shape shape = two_balls();
  const Surface surface = shape.surface();
  const std::vector<Vec3> nearer = with_second_moved(shape, {-0.4, 0.0, 0.0});
  const std::vector<Vec3> aside = with_second_moved(shape, {0.0, 0.9, 0.0});
  const Refined refined = refine_outside(surface, {.edge = 0.05, .poses = {nearer, aside}});
  EXPECT_EQ(refined.original.vertices(), surface.vertices());
  EXPECT_NEAR(refined.surface.area(), surface.area(), 1e-9 * surface.area());
  const Samples fine = sample(refined.surface, 600);
  for (const std::vector<Vec3>& pose : {shape.vertices, nearer, aside}) {
    const Samples samples = to_original(refined, fine);
    const std::vector<double> seen =
        exposure(surface.deformed(pose), samples.faces, samples.barycentric);
    EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 0.0);
  }
  const auto left = [&](const std::vector<std::vector<Vec3>>& poses) {
    return refine_outside(surface, {.edge = 0.05, .poses = poses}).surface.capacity();
  };
  EXPECT_LT(left({nearer, aside}), left({nearer}));
  EXPECT_LT(left({nearer}), left({}));
  EXPECT_NEAR(left({nearer, aside}), left({aside, nearer}), 0.01 * surface.area());
}

TEST(RefineOutside, IsTheSameWithItsOwnPoseAgain) {
  const Shape shape = two_balls(2);
  const Refined once = refine_outside(shape.surface(), {.edge = 0.1});
  const Refined twice = refine_outside(shape.surface(), {.edge = 0.1, .poses = {shape.vertices}});
  EXPECT_EQ(twice.surface.faces(), once.surface.faces());
  EXPECT_EQ(twice.surface.density(), once.surface.density());
}

TEST(RefineOutside, NamesThePoseThatIsWrong) {
  const Shape shape = two_balls(1);
  std::vector<Vec3> broken = shape.vertices;
  broken[3].y() = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const std::vector<Vec3>& pose, const std::string& part) {
    expect_message<ArgumentError>(
        [&] {
          (void)refine_outside(shape.surface(), {.edge = 0.1, .poses = {shape.vertices, pose}});
        },
        {part});
  };
  refused({Vec3::Zero()}, "poses[1] has 1 entries");
  refused(broken, "poses[1][3] is not finite");
  std::vector<Vec3> within = shape.vertices;
  const Shape inner = with_density(shape, [](const Vec3& p) { return p.x() > 1.5 ? 1.0 : 0.0; });
  for (std::size_t v = within.size() / 2; v < within.size(); ++v)
    within[v] = 0.5 * (within[v] - Vec3(kShift, 0.1, 0.05));
  expect_message<ArgumentError>(
      [&] { (void)refine_outside(inner.surface(), {.edge = 0.1, .poses = {within}}); },
      {"nothing of the surface"});
}

TEST(RefineOutside, ItsSamplesLeaveTheBorderOfTheDensityAtCornersToo) {
  // No density left of x = 1/2: some faces right of it touch the border with a corner alone.
  const Shape shape = with_face_density(grid(4), [](const Vec3& p) { return p.x() < 0.5 ? 0 : 1; });
  const Surface surface = shape.surface();
  const std::vector<double> whole(1, std::numeric_limits<double>::infinity());
  Refined refined = refine_edges(surface, whole, 1000);
  refined.inset = 0.05;
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f)
    for (Eigen::Index k = 0; k < 3 && center_of(surface, f).x() > 0.5; ++k) {
      faces.push_back(f);
      weights.push_back(Vec3::Unit(k));
    }
  const Samples corners = bind_samples(refined.surface, faces, weights);
  for (const Vec3& place : to_original(refined, corners).positions) EXPECT_GT(place.x(), 0.52);
}

TEST(RefineOutside, ItsSamplesDoNotLeaveTheBorderAlongNeedles) {
  // The needle's far corner is 0.9 away, its height over the edge to the face without density 0.1.
  const std::vector<Vec3> vertices = {{0, 0, 0}, {0.2, 0, 0}, {1, 0.1, 0}, {0.1, -1, 0}};
  const std::vector<Face> faces = {{0, 1, 2}, {1, 0, 3}};
  const std::vector<double> density = {1.0, 0.0};
  const Surface surface(vertices, faces, Density{DensityAt::kFaces, density});
  const std::vector<double> whole(1, std::numeric_limits<double>::infinity());
  Refined refined = refine_edges(surface, whole, 10);
  refined.inset = 0.05;
  const std::vector<std::int32_t> on = {0};
  const std::vector<Vec3> weights = {{0.5, 0.5, 0.0}};
  const Samples moved = to_original(refined, bind_samples(refined.surface, on, weights));
  EXPECT_GT(moved.positions[0].y(), 0.005);
  EXPECT_LT((moved.positions[0] - Vec3(0.1, 0.0, 0.0)).norm(), 2.0 * refined.inset);
}

TEST(RefineOutside, StopsAtTheLimitOfFaces) {
  const Refined refined = refine_outside(two_balls(2).surface(), {.edge = 0.01, .max_faces = 2000});
  EXPECT_FALSE(refined.resolved);
}

/// Every shape, difficult ones too, keeps its area and its samples are where they should be.
class OutsideOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, OutsideOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(OutsideOf, SamplesAreSeen) {
  const Surface surface = GetParam().surface();
  std::optional<Refined> refined;
  try {
    refined =
        refine_outside(surface, {.edge = 0.05 * std::sqrt(surface.area()), .max_faces = 20000});
  } catch (const ArgumentError&) {
    return;  // all that has a density is hidden
  }
  EXPECT_NEAR(refined->surface.area(), surface.area(), 1e-6 * surface.area());
  const Samples samples = sample(refined->surface, 60);
  check(refined->surface, samples);
  check(surface, to_original(*refined, samples));
}

}  // namespace
}  // namespace dapple::test
