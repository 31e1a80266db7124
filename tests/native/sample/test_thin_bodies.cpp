// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/sampler.hpp>
#include <functional>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

using Curve = std::function<Vec3(double)>;  // parameter: 0 to 1

/// A tube of square section along a curve that never runs along (1, 2, 3).
Shape tube_along(const Curve& curve, double radius, int segments, bool closed = false) {
  Shape shape{"TubeAlong", {}, {}};
  const int rings = closed ? segments : segments + 1;
  for (int k = 0; k < rings; ++k) {
    const double t = static_cast<double>(k) / segments;
    const Vec3 along = curve(t + 1e-4) - curve(t - 1e-4);
    const Vec3 u = along.cross(Vec3(1, 2, 3)).normalized(), v = along.cross(u).normalized();
    for (const Vec3& way : {u, v, Vec3(-u), Vec3(-v)})
      shape.vertices.push_back(curve(t) + radius * way);
  }
  for (int k = 0; k < segments; ++k)
    for (int side = 0; side < 4; ++side) {
      const int next = (k + 1) % rings;
      const int a = 4 * k + side, b = 4 * k + (side + 1) % 4;
      const int c = 4 * next + (side + 1) % 4, d = 4 * next + side;
      shape.faces.push_back({a, b, c});
      shape.faces.push_back({a, c, d});
    }
  if (closed) return shape;
  const int last = 4 * segments;
  for (const Face& face :
       {Face{0, 2, 1}, {0, 3, 2}, {last, last + 1, last + 2}, {last, last + 2, last + 3}})
    shape.faces.push_back(face);
  return shape;
}

Shape fence(double radius, int segments) {
  Shape shape{"Fence", {}, {}};
  for (int wire = 0; wire < 20; ++wire)
    shape = joined(shape, tube_along([&](double t) { return Vec3(2.0 * t, 0.1 * wire, 0); }, radius,
                                     segments));
  return shape;
}

Vec3 helix(double t) {
  const double turn = 6.0 * std::numbers::pi * t;
  return {std::cos(turn), std::sin(turn), 1.5 * t};
}

Vec3 loop(double t) {
  const double turn = 2.0 * std::numbers::pi * t;
  return {std::cos(turn), std::sin(turn), 0.3 * std::sin(2.0 * turn)};
}

/// A strip of faces on one side only.
Shape ribbon(double width, int segments) {
  Shape shape{"Ribbon", {}, {}};
  for (int k = 0; k <= segments; ++k) {
    const double x = 4.0 * k / segments;
    for (const double z : {0.0, width}) shape.vertices.push_back({x, 0.2 * std::sin(3.0 * x), z});
  }
  for (int k = 0; k < segments; ++k) {
    shape.faces.push_back({2 * k, 2 * k + 2, 2 * k + 3});
    shape.faces.push_back({2 * k, 2 * k + 3, 2 * k + 1});
  }
  return shape;
}

/// A bent sheet with thickness, closed along its rim.
Shape bent_shell(int cells, double thickness) {
  return mapped(box(cells), [=](const Vec3& p) {
    const double height = 0.25 * std::sin(3.0 * p.x()) * std::cos(4.0 * p.y());
    return Vec3(p.x(), p.y(), height + thickness * p.z());
  });
}

/// Samples of 20 seeds are even, after few evaluations.
void expect_even(const Shape& shape, std::size_t count, double thin_share) {
  const Surface surface = shape.surface();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SampleOptions options;
    options.seed = seed;
    const Samples samples = sample(surface, count, options);
    check(surface, samples);
    EXPECT_LE(samples.report.evenness.capacity_variation, 0.01) << seed;
    EXPECT_LE(samples.report.evaluations, 40) << seed;
    EXPECT_TRUE(samples.report.converged) << seed;
    EXPECT_EQ(samples.report.evenness.thin_share, thin_share) << seed;
    if (thin_share == 1.0) {
      EXPECT_EQ(samples.report.evenness.alpha_mean, 0.0) << seed;
    }
  }
}

TEST(ThinBodies, WiresOfAFenceAreEvenAlongTheirLength) {
  expect_even(fence(0.002, 1), 200, 1.0);
  expect_even(fence(2e-5, 20), 200, 1.0);
  expect_even(fence(0.0003, 50), 60, 1.0);
}

TEST(ThinBodies, ARopeHasNoGaps) {
  expect_even(tube_along(helix, 0.005, 300), 100, 1.0);
  expect_even(tube_along(helix, 1e-4, 300), 200, 1.0);
}

TEST(ThinBodies, AThickRopeIsEvenToo) { expect_even(tube_along(helix, 0.03, 300), 300, 0.0); }

TEST(ThinBodies, AClosedRopeHasNoSeam) {
  expect_even(tube_along(loop, 0.003, 200, true), 100, 1.0);
}

TEST(ThinBodies, ARibbonIsEvenAlongItsLength) {
  expect_even(ribbon(0.01, 200), 100, 1.0);
  expect_even(ribbon(0.04, 200), 100, 0.0);
}

TEST(ThinBodies, PlatesAreEvenOnBothSides) {
  const auto flat = [](double x, double y, double z) {
    return mapped(box(1), [=](const Vec3& p) { return Vec3(x * p.x(), y * p.y(), z * p.z()); });
  };
  expect_even(flat(1.0, 1.0, 0.002), 500, 0.0);
  expect_even(flat(1.0, 0.7, 0.004), 333, 0.0);
  expect_even(flat(4.0, 0.06, 0.002), 60, 1.0);
}

TEST(ThinBodies, ABentShellIsEvenOnBothSides) { expect_even(bent_shell(40, 0.01), 1000, 0.0); }

TEST(ThinBodies, ARopeFollowsItsDensity) {
  const Shape rope = tube_along(helix, 0.005, 300);
  std::vector<double> density;
  for (const Vec3& p : rope.vertices) density.push_back(p.z() > 0.75 ? 0.0 : 1.0 + p.z());
  const Surface surface(rope.vertices, rope.faces, density);
  const Samples samples = sample(surface, 100);
  check(surface, samples);
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.01);
}

TEST(ThinBodies, RandomStartsOnWiresAreMadeEven) {
  SampleOptions options;
  options.start = Start::kRandom;
  const Samples samples = sample(fence(2e-5, 20).surface(), 200, options);
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.01);
}

TEST(ThinBodies, ASphereBesideAFenceKeepsItsSpacing) {
  const Surface surface =
      joined(mapped(icosphere(3), [](const Vec3& p) { return Vec3(0.5 * p); }), fence(0.002, 1))
          .surface();
  const Evenness evenness = sample(surface, 500).report.evenness;
  EXPECT_GT(evenness.thin_share, 0.1);
  EXPECT_LT(evenness.thin_share, 0.9);
  EXPECT_GT(evenness.alpha_min, 0.5);
  EXPECT_LT(evenness.alpha_mean, 1.0);
}

}  // namespace
}  // namespace dapple::test
