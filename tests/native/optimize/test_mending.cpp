// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <dapple/exposure.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>
#include <numbers>
#include <random>

#include "shapes.hpp"

namespace dapple::test {
namespace {

Shape placed(const Shape& shape, const Vec3& size, double turn, const Vec3& at) {
  const Eigen::Matrix3d turned(Eigen::AngleAxisd(turn, Vec3(1.0, 0.4, 0.2).normalized()));
  return mapped(shape, [&](const Vec3& p) {
    return Vec3(turned * (p - Vec3::Constant(0.5)).cwiseProduct(size) + at);
  });
}

/// Two boards that cross at an acute angle, with narrow grooves between them.
Shape crossing_boards() {
  return joined(placed(box(2), {2.0, 1.0, 0.2}, 0.0, {0, 0, 0}),
                placed(box(2), {1.8, 1.0, 0.15}, 0.5, {0.1, 0, 0.02}));
}

/// Many boxes thrown onto a heap.
Shape heap() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-0.6, 0.6), size(0.3, 1.0), turn(0.0, 3.0);
  Shape result = placed(box(1), {1, 1, 1}, 0.0, {0, 0, 0});
  for (int k = 0; k < 14; ++k)
    result = joined(result, placed(box(1), {size(random), size(random), 0.4 * size(random)},
                                   turn(random), {at(random), at(random), at(random)}));
  return result;
}

/// Distance of the nearest two samples on different boxes of 12 * n * n faces, in spacings.
double nearest_on_two(const Surface& skin, const Samples& samples, std::int32_t faces_of_one) {
  const double area = skin.capacity() / static_cast<double>(samples.size());
  const double spacing = std::sqrt(2.0 * area / std::numbers::sqrt3);
  double least = 1.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (samples.faces[i] / faces_of_one != samples.faces[j] / faces_of_one)
        least = std::min(least, (samples.positions[i] - samples.positions[j]).norm() / spacing);
  return least;
}

void check(const Shape& shape, std::int32_t faces_of_one, std::size_t count) {
  const Surface surface = shape.surface();
  const Refined refined = refine_outside(surface, {.edge = 0.1 * surface.spacing(count)});
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Samples samples = to_original(refined, sample(refined.surface, count, {.seed = seed}));
    EXPECT_GE(nearest_on_two(refined.surface, samples, faces_of_one), 0.6) << "seed " << seed;
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.02) << "seed " << seed;
    EXPECT_TRUE(samples.report.converged) << "seed " << seed;
  }
}

TEST(Mending, KeepsSamplesApartInGroovesBetweenBodies) { check(crossing_boards(), 48, 600); }

TEST(Mending, KeepsSamplesApartOnAHeapOfBodies) { check(heap(), 12, 800); }

TEST(Mending, KeepsSamplesApartOnAHeapOfSoup) { check(soup(heap()), 12, 800); }

TEST(Mending, EndsAtTheLimitOfEvaluations) {
  const Surface surface = heap().surface();
  const Refined refined = refine_outside(surface, {.edge = 0.1 * surface.spacing(800)});
  const Samples samples = sample(refined.surface, 800, {.optimizer = {.max_evaluations = 40}});
  EXPECT_LE(samples.report.evaluations, 40);
}

TEST(Mending, DoesNotDependOnTheThreads) {
  const Surface surface = crossing_boards().surface();
  const Refined refined = refine_outside(surface, {.edge = 0.1 * surface.spacing(600)});
  const Samples one = sample(refined.surface, 600, {.threads = 1});
  const Samples more = sample(refined.surface, 600, {.threads = 3});
  EXPECT_EQ(one.positions, more.positions);
}

}  // namespace
}  // namespace dapple::test
