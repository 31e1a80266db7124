// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <limits>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

struct Balls {
  std::vector<Vec3> points;
  std::vector<double> radii;

  [[nodiscard]] Obstacles obstacles() const { return {points, radii, {}}; }

  /// The distance from the nearest ball; negative inside.
  [[nodiscard]] double clearance(const Vec3& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points.size(); ++k)
      least = std::min(least, (points[k] - p).norm() - radii[k]);
    return least;
  }
};

Balls balls_on(const Shape& shape, std::size_t count, double radius, std::uint64_t seed) {
  Random random(seed);
  Balls balls{random_sites(shape, count, random).positions, {}};
  for (std::size_t k = 0; k < count; ++k) balls.radii.push_back(radius * random.between(0.2, 1.0));
  return balls;
}

class ObstaclesOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ObstaclesOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ObstaclesOn, KeepSamplesAway) {
  const Shape& shape = GetParam();
  const Surface surface = shape.surface();
  const Balls balls = balls_on(shape, 6, 0.1 * std::sqrt(surface.area()), 3);
  const Refined refined = refine_obstacles(surface, balls.obstacles());
  EXPECT_TRUE(refined.resolved);
  const Samples samples = sample(refined.surface, 150);
  check(refined.surface, samples);
  for (const Vec3& p : samples.positions) ASSERT_GE(balls.clearance(p), 0.0);
  for (const Vec3& p : to_original(refined, samples).positions) ASSERT_GE(balls.clearance(p), 0.0);
}

/// The density is 0 in the balls and at most on the faces at their borders besides.
TEST(RefineObstacles, TakesLittleMoreThanTheBalls) {
  const Shape shape = grid(3);
  const Balls balls{{{0.3, 0.3, 0}, {0.7, 0.6, 0.1}}, {0.1, 0.2}};
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
  const double discs = std::numbers::pi * (0.01 + 0.03);
  EXPECT_LE(refined.surface.capacity(), 1.0 - discs);
  EXPECT_GE(refined.surface.capacity(), 1.0 - 1.2 * discs);
  EXPECT_LT(refined.surface.face_count(), 5000u);
}

TEST(RefineObstacles, StayEvenOutside) {
  const Shape shape = blob(4);
  const Balls balls = balls_on(shape, 40, 0.2, 5);
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
  const Samples samples = sample(refined.surface, 1000);
  for (const Vec3& p : samples.positions) ASSERT_GE(balls.clearance(p), 0.0);
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.01);
  EXPECT_GE(samples.report.evenness.alpha_min, 0.4);
}

TEST(RefineObstacles, KeepTheDensityElsewhere) {
  const Shape shape = with_density(grid(4), [](const Vec3& p) { return 1.0 + p.x(); });
  const Balls balls{{{0.5, 0.5, 0}}, {0.05}};
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
  int kept = 0;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(refined.surface.face_count()); ++f) {
    const Vec3 values = refined.surface.ordered().densities(OrderedFace{f});
    if (values.isZero(0.0)) continue;
    ++kept;
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_NEAR(values[static_cast<Eigen::Index>(k)],
                  1.0 + refined.surface.ordered()
                            .vertex(refined.surface.ordered().corners(OrderedFace{f})[k])
                            .x(),
                  1e-13);
  }
  EXPECT_GT(kept, 32);
}

TEST(RefineObstacles, KeepSamplesOffAreas) {
  const Shape shape = box(6);
  std::vector<std::uint8_t> areas(shape.faces.size(), 0);
  for (std::size_t f = 0; f < areas.size(); f += 3) areas[f] = 1;
  const Refined refined = refine_obstacles(shape.surface(), {{}, {}, areas});
  EXPECT_EQ(refined.surface.face_count(), shape.faces.size());
  for (const std::int32_t f : sample(refined.surface, 300).faces)
    ASSERT_EQ(areas[static_cast<std::size_t>(f)], 0);
}

TEST(RefineObstacles, MayBeMuchSmallerThanFaces) {
  const Shape shape = grid(1);
  const Balls balls{{{0.4, 0.7, 0}}, {1e-5}};
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
  EXPECT_TRUE(refined.resolved);
  EXPECT_LT(refined.surface.face_count(), 2000u);
  EXPECT_NEAR(refined.surface.capacity(), 1.0 - std::numbers::pi * 1e-10, 0.3e-10);
}

TEST(RefineObstacles, KeepTheirDistanceWhateverTheLimitOfFaces) {
  const Shape shape = blob(2);
  const Balls balls = balls_on(shape, 5, 0.3, 8);
  ObstacleOptions options;
  options.max_faces = 400;
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles(), options);
  EXPECT_FALSE(refined.resolved);
  for (const Vec3& p : sample(refined.surface, 100).positions) EXPECT_GE(balls.clearance(p), 0.0);
}

TEST(RefineObstacles, DoNotDependOnUnits) {
  for (const double scale : {1e-6, 1e6}) {
    const Shape shape = mapped(blob(2), [&](const Vec3& p) { return Vec3(scale * p); });
    Balls balls = balls_on(shape, 8, 0.2 * scale, 9);
    const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
    const Samples samples = to_original(refined, sample(refined.surface, 200));
    for (const Vec3& p : samples.positions) EXPECT_GE(balls.clearance(p), 0.0);
  }
}

/// Samples of a tracker on the fine surface stay off the faces without density.
TEST(RefineObstacles, HoldWhileTheSurfaceDeforms) {
  const Shape shape = blob(3);
  const Balls balls = balls_on(shape, 10, 0.25, 10);
  const Refined refined = refine_obstacles(shape.surface(), balls.obstacles());
  Tracker tracker(refined.surface, sample(refined.surface, 300));
  for (const double time : {0.3, 0.6, 0.9}) {
    const Samples samples = tracker.advance(refined.vertices(deformed(shape.vertices, time)));
    for (const std::int32_t f : samples.faces)
      ASSERT_GT(tracker.surface()
                    .ordered()
                    .densities(tracker.surface().ordered().ordered_face(f))
                    .maxCoeff(),
                0.0);
  }
}

TEST(RefineObstacles, NameTheFirstOffender) {
  const Surface surface = grid(2).surface();
  Balls balls{{{0, 0, 0}, {1, 1, 0}}, {0.1, 0.0}};
  const auto refine = [&] { (void)refine_obstacles(surface, balls.obstacles()); };
  expect_message<ArgumentError>(refine, {"radii[1]", "0"});
  balls.radii[1] = -0.1;
  expect_message<ArgumentError>(refine, {"radii[1]", "-0.1"});
  balls.points[0].x() = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>(refine, {"points[0]", "nan"});
  balls.radii.pop_back();
  expect_message<ArgumentError>(refine, {"radii", "1", "2"});
  balls = {{{0.5, 0.5, 0}}, {2.0}};
  expect_message<ArgumentError>(refine, {"points", "all of the surface"});
  const std::vector<std::uint8_t> areas(7, 0);
  expect_message<ArgumentError>([&] { (void)refine_obstacles(surface, {{}, {}, areas}); },
                                {"areas", "7", "8"});
  ObstacleOptions options;
  options.edge = 0.0;
  expect_message<ArgumentError>([&] { (void)refine_obstacles(surface, {}, options); }, {"edge"});
}

}  // namespace
}  // namespace dapple::test
