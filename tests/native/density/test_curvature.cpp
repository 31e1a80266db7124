// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/curvature.hpp>
#include <dapple/errors.hpp>
#include <limits>
#include <numbers>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

/// The largest deviation from the expected values, relative to the largest of them.
double worst(const Shape& shape, int smoothing, const DensityFunction& expected) {
  const std::vector<double> found = curvedness(shape.surface(), smoothing);
  double off = 0.0, most = 0.0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    const double value = expected(shape.vertices[v]);
    off = std::max(off, std::abs(found[v] - value));
    most = std::max(most, value);
  }
  return off / most;
}

Shape scaled(const Shape& shape, double scale) {
  return mapped(shape, [&](const Vec3& p) { return Vec3(scale * p); });
}

double torus_curvedness(const Vec3& p) {
  const double around = std::hypot(p.x(), p.y());
  const double along_ring = (around - 1.0) / 0.4 / around;
  return std::hypot(1.0 / 0.4, along_ring) / std::numbers::sqrt2;
}

/// The mean, and the standard deviation divided by it.
std::array<double, 2> spread(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean};
}

/// A scanned sphere; `error` is relative to the distance between vertices.
Shape noisy_sphere(double noise) {
  const Shape sphere = icosphere(5);
  const double pitch =
      std::sqrt(4.0 * std::numbers::pi / static_cast<double>(sphere.vertices.size()));
  Random random(11);
  return mapped(sphere, [&](const Vec3& p) { return Vec3(p + noise * pitch * random.in_box()); });
}

TEST(Curvedness, IsTheInverseRadiusOnASphere) {
  for (const double radius : {1.0, 1e-6, 1e6})
    for (const int smoothing : {0, 2})
      EXPECT_LE(
          worst(scaled(icosphere(4), radius), smoothing, [&](const Vec3&) { return 1.0 / radius; }),
          0.015);
}

/// Radius 0.5: the principal curvatures are 2 and 0.
TEST(Curvedness, IsTheRootMeanSquareOnACylinder) {
  EXPECT_LE(worst(tube(64, 40), 2, [](const Vec3&) { return std::numbers::sqrt2; }), 0.02);
}

TEST(Curvedness, VariesOverATorus) {
  EXPECT_LE(worst(torus(160, 80), 0, torus_curvedness), 0.02);
  EXPECT_LE(worst(torus(160, 80), 2, torus_curvedness), 0.03);
}

TEST(Curvedness, VanishesOnAPlane) {
  const Shape tilted = mapped(grid(8), [](const Vec3& p) { return rotated(p, 0.7); });
  for (const double value : curvedness(tilted.surface())) EXPECT_LE(value, 1e-12);
}

TEST(Curvedness, ToleratesNoise) {
  const auto [mean, rough] = spread(curvedness(noisy_sphere(0.05).surface(), 0));
  const auto [smooth_mean, smooth] = spread(curvedness(noisy_sphere(0.05).surface()));
  std::cout << "noisy sphere: mean " << mean << ", spread " << rough << "; smoothed " << smooth_mean
            << ", " << smooth << '\n';
  EXPECT_NEAR(smooth_mean, 1.0, 0.1);
  EXPECT_LE(smooth, 0.2);
  EXPECT_GE(rough, 2.0 * smooth);
}

/// Half a sphere: normals at its border are averages over faces on one side only.
TEST(Curvedness, CopiesInteriorValuesToABorder) {
  Shape half = icosphere(4);
  std::erase_if(half.faces, [&](const Face& face) {
    return std::any_of(face.begin(), face.end(), [&](std::int32_t v) {
      return half.vertices[static_cast<std::size_t>(v)].z() < 0.1;
    });
  });
  const std::vector<double> found = curvedness(half.surface());
  for (const Face& face : half.faces)
    for (const std::int32_t v : face) EXPECT_NEAR(found[static_cast<std::size_t>(v)], 1.0, 0.1);
}

TEST(Curvedness, IgnoresTheOrientationOfFaces) {
  const Shape straight = blob(3);
  Shape turned = straight;
  for (std::size_t f = 0; f < turned.faces.size(); f += 3)
    std::swap(turned.faces[f][1], turned.faces[f][2]);
  const std::vector<double> a = curvedness(straight.surface()), b = curvedness(turned.surface());
  for (std::size_t v = 0; v < a.size(); ++v) EXPECT_NEAR(a[v], b[v], 1e-9 * a[v]);
}

TEST(Curvedness, IgnoresTheDensity) {
  const Shape shape = blob(2);
  EXPECT_EQ(curvedness(shape.surface()),
            curvedness(with_face_density(shape, [](const Vec3& p) { return p.norm(); }).surface()));
}

class CurvatureOf : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, CurvatureOf, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(CurvatureOf, MakesADensity) {
  const Surface surface = GetParam().surface();
  for (const int smoothing : {0, 1, 5}) {
    CurvatureOptions options;
    options.smoothing = smoothing;
    const std::vector<double> density = curvature_density(surface, options);
    ASSERT_EQ(density.size(), surface.vertex_count());
    for (const double value : density) ASSERT_TRUE(value >= 0.1 && value <= 1.0) << value;
    EXPECT_EQ(*std::max_element(density.begin(), density.end()), 1.0);
    EXPECT_GT(surface.with_density({DensityAt::kVertices, density}).capacity(), 0.0);
  }
}

TEST(CurvatureDensity, IsOneOnAPlane) {
  const Shape tilted = mapped(grid(5), [](const Vec3& p) { return rotated(p, 0.7); });
  for (const double value : curvature_density(tilted.surface())) EXPECT_EQ(value, 1.0);
}

TEST(CurvatureDensity, GrowsTowardTheEdgesOfABox) {
  const Shape shape = box(24);
  const std::vector<double> density = curvature_density(shape.surface());
  for (std::size_t v = 0; v < density.size(); ++v) {
    const Vec3 inside = shape.vertices[v].cwiseMin(Vec3::Ones() - shape.vertices[v]);
    std::array<double, 3> sorted = {inside[0], inside[1], inside[2]};
    std::sort(sorted.begin(), sorted.end());
    if (sorted[1] > 0.25) {
      EXPECT_NEAR(density[v], 0.1, 1e-9);
    }
    if (sorted[1] == 0.0) {
      EXPECT_GE(density[v], 0.9);
    }
  }
}

TEST(CurvatureDensity, FollowsItsFormula) {
  const Surface surface = torus(80, 40).surface();
  const std::vector<double> values = curvedness(surface, 1);
  const double most = *std::max_element(values.begin(), values.end());
  const std::vector<double> density = curvature_density(surface, {2.0, 0.25, 100.0, 1});
  for (std::size_t v = 0; v < values.size(); ++v)
    EXPECT_NEAR(density[v], 0.25 + 0.75 * std::pow(values[v] / most, 2.0), 1e-12);
  const std::vector<double> clamped = curvature_density(surface, {1.0, 0.0, 50.0, 1});
  const auto full = std::count(clamped.begin(), clamped.end(), 1.0);
  EXPECT_GT(full, 0.25 * static_cast<double>(clamped.size()));
  EXPECT_LT(full, 0.75 * static_cast<double>(clamped.size()));
}

TEST(CurvatureDensity, NamesTheOptionOutOfRange) {
  const Surface surface = grid(2).surface();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect = [&](const CurvatureOptions& options, const char* name) {
    expect_message<ArgumentError>([&] { (void)curvature_density(surface, options); }, {name});
  };
  for (const double bad : {0.0, -1.0, nan}) expect({bad, 0.1, 95.0, 2}, "exponent");
  for (const double bad : {-0.1, 1.1, nan}) expect({1.0, bad, 95.0, 2}, "floor");
  for (const double bad : {0.0, 100.5, nan}) expect({1.0, 0.1, bad, 2}, "percentile");
  for (const int bad : {-1, 101}) expect({1.0, 0.1, 95.0, bad}, "smoothing");
}

}  // namespace
}  // namespace dapple::test
