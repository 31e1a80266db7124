// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/symmetric_samples.hpp>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kExact = 1e-9;  // of bodies of size 1

const Vec3 kMiddle = Vec3::Constant(0.5);  // of box()

SymmetryOptions across(const Vec3& normal, const Vec3& point = Vec3::Zero()) {
  SymmetryOptions options;
  options.normal = normal;
  options.point = point;
  return options;
}

Vec3 reflected(const Vec3& p, const SymmetryOptions& options) {
  const Vec3 normal = options.normal.normalized();
  return p - 2.0 * normal.dot(p - options.point) * normal;
}

std::size_t on_plane(const SymmetricSamples& found) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < found.mirror.size(); ++k)
    if (found.mirror[k] == static_cast<std::int32_t>(k)) ++count;
  return count;
}

void expect_pairs(const SymmetricSamples& found, const SymmetryOptions& options, double exact) {
  const std::vector<Vec3>& positions = found.samples.positions;
  ASSERT_EQ(found.mirror.size(), positions.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const auto image = static_cast<std::size_t>(found.mirror[k]);
    ASSERT_EQ(found.mirror[image], static_cast<std::int32_t>(k));
    EXPECT_LE((positions[image] - reflected(positions[k], options)).norm(), exact) << k;
    if (image == k + 1) {
      EXPECT_GT(options.normal.dot(positions[k] - options.point), 0.0);
    }
  }
  EXPECT_LE(found.mirror_error, exact);
}

/// The nearest neighbor of samples near the plane, in spacings.
double nearest_at_plane(const SymmetricSamples& found, const SymmetryOptions& options) {
  const std::vector<Vec3>& positions = found.samples.positions;
  const double spacing = found.samples.report.spacing;
  double nearest = kInfinite;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    if (std::abs(options.normal.normalized().dot(positions[k] - options.point)) > spacing) continue;
    for (std::size_t j = 0; j < positions.size(); ++j)
      if (j != k) nearest = std::min(nearest, (positions[k] - positions[j]).norm() / spacing);
  }
  return nearest;
}

TEST(SampleSymmetric, ComeInPairsOfMirrorImagesInExactlyTheirNumber) {
  const Surface surface = box(4).surface();
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, -3, 0), Vec3(0, 0, 1), Vec3(1, 1, 0)})
    for (const std::size_t count : {0u, 1u, 2u, 7u, 60u, 301u}) {
      const SymmetryOptions options = across(normal, kMiddle);
      const SymmetricSamples found = sample_symmetric(surface, count, options);
      EXPECT_EQ(found.samples.size(), count);
      EXPECT_EQ((count - on_plane(found)) % 2, 0u);
      expect_pairs(found, options, kExact);
    }
}

TEST(SampleSymmetric, AreAsEvenAtThePlaneAsElsewhere) {
  const Surface surface = icosphere(4).surface();
  for (const std::uint64_t seed : {0u, 1u, 2u, 3u}) {
    SymmetryOptions options = across(Vec3::UnitX());
    options.sample.seed = seed;
    const SymmetricSamples found = sample_symmetric(surface, 600, options);
    const Report& report = found.samples.report;
    EXPECT_LT(report.evenness.capacity_variation, 0.01);
    EXPECT_GT(report.evenness.alpha_min, 0.65);
    EXPECT_TRUE(report.converged);
    EXPECT_GT(nearest_at_plane(found, options), 0.65);
    // A circle of length 2 pi with one each sqrt(3) spacings, half and twice as many.
    const double usual = 2.0 * 3.14159 / (1.732 * report.spacing);
    EXPECT_GT(static_cast<double>(on_plane(found)), 0.5 * usual);
    EXPECT_LT(static_cast<double>(on_plane(found)), 2.0 * usual);
  }
}

TEST(SampleSymmetric, NeedNoSymmetricFaces) {
  // The diagonals of the squares all have the same direction.
  const Shape shape = mapped(grid(7), [](const Vec3& p) {
    return Vec3(p[0] - 0.5, p[1], 0.3 * (p[0] - 0.5) * (p[0] - 0.5));
  });
  const SymmetryOptions options = across(Vec3::UnitX());
  const SymmetricSamples found = sample_symmetric(shape.surface(), 300, options);
  expect_pairs(found, options, 2e-3);  // by which the diagonals bend the faces
  EXPECT_LT(found.samples.report.evenness.capacity_variation, 0.02);
}

TEST(SampleSymmetric, StayOnThePlaneWhereItIsACrease) {
  const Shape roof = mapped(grid(6), [](const Vec3& p) {
    return Vec3(p[0] - 0.5, p[1], 0.2 * p[1] * p[1] - std::abs(p[0] - 0.5));
  });
  const SymmetryOptions options = across(Vec3::UnitX());
  const SymmetricSamples found = sample_symmetric(roof.surface(), 251, options);
  EXPECT_GT(on_plane(found), 4u);
  for (std::size_t k = 0; k < 251; ++k)
    if (found.mirror[k] == static_cast<std::int32_t>(k)) {
      EXPECT_NEAR(found.samples.positions[k][0], 0.0, kExact);
    }
  EXPECT_LT(found.samples.report.evenness.capacity_variation, 0.02);
}

TEST(SampleSymmetric, OnTwoBodiesAreInPairsWithoutThePlane) {
  const Shape left = mapped(box(3), [](const Vec3& p) { return Vec3(p[0] + 1.0, p[1], p[2]); });
  const Shape right = mapped(left, [](const Vec3& p) { return Vec3(-p[0], p[1], p[2]); });
  const Surface surface = joined(left, right).surface();
  const SymmetryOptions options = across(Vec3::UnitX());
  const SymmetricSamples found = sample_symmetric(surface, 100, options);
  expect_pairs(found, options, kExact);
  EXPECT_EQ(on_plane(found), 0u);
  expect_message<ArgumentError>([&] { (void)sample_symmetric(surface, 101, options); },
                                {"count is 101", "must be even"});
}

TEST(SampleSymmetric, FollowTheMeanOfADensityAndItsImage) {
  // 4 on one side, 0 on the other: 2 on both.
  const Shape shape = with_face_density(
      box(4), [](const Vec3& p) { return (p[0] > 0.5 ? 4.0 : 0.0) + (p[1] > 0.5 ? 2.0 : 0.0); });
  const SymmetryOptions options = across(Vec3::UnitX(), kMiddle);
  const SymmetricSamples found = sample_symmetric(shape.surface(), 300, options);
  expect_pairs(found, options, kExact);
  const auto dense =
      std::ranges::count_if(found.samples.positions, [](const Vec3& p) { return p[1] > 0.5; });
  EXPECT_NEAR(static_cast<double>(dense), 200.0, 8.0);  // density 4, and 2
  EXPECT_LT(found.samples.report.evenness.capacity_variation, 0.02);
}

TEST(SampleSymmetric, LeaveOutWhatIsMasked) {
  Shape shape = joined(box(4), mapped(box(2), [](const Vec3& p) -> Vec3 {
                         return p + Vec3(3.0, 0.0, 0.0);  // a body on one side only
                       }));
  const SymmetryOptions options = across(Vec3::UnitX(), kMiddle);
  expect_message<ArgumentError>([&] { (void)sample_symmetric(shape.surface(), 40, options); },
                                {"not symmetric", "vertices[", "max_mirror_error"});
  shape = with_face_density(shape, [](const Vec3& p) { return p[0] < 2.0 ? 1.0 : 0.0; });
  expect_pairs(sample_symmetric(shape.surface(), 40, options), options, kExact);
}

TEST(SampleSymmetric, RefuseWhatIsOutOfRange) {
  const Surface surface = box(2).surface();
  const auto refused = [&](const SymmetryOptions& options, const std::string& words) {
    expect_message<ArgumentError>([&] { (void)sample_symmetric(surface, 8, options); }, {words});
  };
  refused(across(Vec3::Zero(), kMiddle), "normal is (0, 0, 0)");
  refused(across(Vec3(0, kInfinite, 0), kMiddle), "normal[0] is not finite");
  refused(across(Vec3::UnitX(), Vec3(std::nan(""), 0, 0)), "point[0] is not finite");
  refused(across(Vec3::UnitX(), Vec3(0.4, 0, 0)), "surface is not symmetric");
  refused(across(Vec3::UnitX(), Vec3(1e308, 0, 0)), "not finite");
  SymmetryOptions options = across(Vec3::UnitX(), kMiddle);
  options.max_mirror_error = -1.0;
  refused(options, "max_mirror_error");
  options = across(Vec3::UnitX(), kMiddle);
  options.sample.locked = {{Vec3::Zero()}, {0}, {Vec3::UnitX()}};
  refused(options, "locked");
}

class SymmetricShapes : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(All, SymmetricShapes, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(SymmetricShapes, GetPairsOrAreRefused) {
  const Surface surface = GetParam().surface();
  for (const std::size_t count : {1u, 8u, 50u}) try {
      const SymmetricSamples found = sample_symmetric(surface, count);
      ASSERT_EQ(found.samples.size(), count);
      for (std::size_t k = 0; k < count; ++k)
        ASSERT_EQ(found.mirror[static_cast<std::size_t>(found.mirror[k])],
                  static_cast<std::int32_t>(k));
    } catch (const ArgumentError&) {  // it is not symmetric, or does not cross the plane
    }
}

}  // namespace
}  // namespace dapple::test
