// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/decals.hpp>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <numbers>

#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kRows = 60;

/// One texel in the middle of every face.
Texels middles(const Surface& surface) {
  Texels result{surface.face_count(), 1, {}, {}};
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    result.faces.push_back(static_cast<std::int32_t>(f));
    result.barycentric.emplace_back(Vec3::Constant(1.0 / 3.0));
  }
  return result;
}

/// The unit square from above.
Texels flat_texels(const Shape& shape) {
  std::vector<FaceUv> uv;
  for (const Face& face : shape.faces) {
    FaceUv& row = uv.emplace_back();
    for (std::size_t c = 0; c < 3; ++c)
      row[c] = shape.vertices[static_cast<std::size_t>(face[c])].head<2>();
  }
  return texels(shape.surface(), uv, kRows, kRows, 0);
}

Samples middle_of_the_square(const Surface& surface) {
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f)
    for (std::size_t c = 0; c < 3; ++c) {
      Vec3 weights = Vec3::Zero();
      weights[static_cast<Eigen::Index>(c)] = 1.0;
      if ((surface.point(f, weights) - Vec3(0.5, 0.5, 0.0)).norm() < 1e-12)
        return bind_samples(surface, std::vector{f}, std::vector{weights});
    }
  throw std::logic_error("no vertex in the middle");
}

TEST(Decals, LieInTheTangentsFrame) {
  const Shape shape = grid(2);
  const Surface surface = shape.surface();
  const Texels texels = flat_texels(shape);
  const double angle = 0.4;
  const std::vector<Vec3> tangents = {Vec3(3.0 * std::cos(angle), 3.0 * std::sin(angle), 5.0)};
  const DecalCover found =
      decal_cover(surface, middle_of_the_square(surface), std::vector{0.25}, tangents, texels);
  std::size_t covered = 0;
  for (std::size_t k = 0; k < texels.size(); ++k) {
    const Vec3 p = surface.point(texels.faces[k], texels.barycentric[k]);
    const Vec2 way = Eigen::Rotation2Dd(-angle) * Vec2((p - Vec3(0.5, 0.5, 0.0)).head<2>() / 0.25);
    const bool inside = way.cwiseAbs().maxCoeff() <= 1.0;
    EXPECT_EQ(found.samples[k], inside ? 0 : -1);
    if (!inside) continue;
    ++covered;
    EXPECT_NEAR((found.places[k] - way).norm(), 0.0, 1e-12);
  }
  EXPECT_NEAR(static_cast<double>(covered) / (kRows * kRows), 0.25, 0.02);
}

TEST(Decals, KeepDistancesOnACurvedSurface) {
  const Surface surface = icosphere(4).surface();
  const Samples samples = sample(surface, 20);
  const std::vector<double> radii(20, 0.3);
  const std::vector<Vec3> tangents(20, Vec3(0.3, 0.4, 0.5));
  const Texels texels = middles(surface);
  const DecalCover found = decal_cover(surface, samples, radii, tangents, texels);
  std::size_t covered = 0;
  for (std::size_t k = 0; k < texels.size(); ++k) {
    if (found.samples[k] < 0) continue;
    ++covered;
    const Vec3 p = surface.point(texels.faces[k], texels.barycentric[k]);
    const Vec3& middle = samples.positions[static_cast<std::size_t>(found.samples[k])];
    EXPECT_NEAR(found.places[k].norm(), (p - middle).norm() / 0.3, 1e-12);
    for (const Vec3& other : samples.positions) {
      const double distance = (p - other).norm();
      if (distance > 0.3) continue;  // the texel may lie beside the square
      EXPECT_GE(distance, (p - middle).norm() - 1e-12) << "the nearest has it";
    }
  }
  EXPECT_GT(covered, texels.size() / 3);
}

TEST(Decals, StayOnTheirSheet) {
  const Shape sheets = two_sheets(6, 0.01);
  const Surface surface = sheets.surface();
  const Samples samples = bind_samples(surface, std::vector{0}, std::vector{Vec3(0.2, 0.3, 0.5)});
  const DecalCover found = decal_cover(surface, samples, std::vector{0.5},
                                       std::vector{Vec3(Vec3::UnitX())}, middles(surface));
  const Vec3 normal = samples.normals[0];
  bool some = false;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    if (found.samples[f] < 0) continue;
    some = true;
    EXPECT_GT(surface.ordered()
                  .geometry(surface.ordered().ordered_face(static_cast<std::int32_t>(f)))
                  .normal.dot(normal),
              0.0);
  }
  EXPECT_TRUE(some);
}

TEST(Decals, WithoutRadiusCoverNothing) {
  const Surface surface = grid(4).surface();
  const DecalCover found = decal_cover(surface, middle_of_the_square(surface), std::vector{0.0},
                                       std::vector{Vec3(Vec3::UnitX())}, flat_texels(grid(4)));
  EXPECT_EQ(std::count(found.samples.begin(), found.samples.end(), -1), kRows * kRows);
}

TEST(Decals, NameWhatIsWrong) {
  const Surface surface = grid(2).surface();
  const Samples samples = sample(surface, 3);
  const Texels texels = flat_texels(grid(2));
  std::vector<double> radii(3, 0.1);
  std::vector<Vec3> tangents(3, Vec3::UnitX());
  const auto run = [&] { (void)decal_cover(surface, samples, radii, tangents, texels); };
  radii[1] = -0.5;
  expect_message<ArgumentError>(run, {"radii[1]", "-0.5"});
  radii[1] = 0.1;
  tangents[2] = Vec3::UnitZ();
  expect_message<ArgumentError>(run, {"tangents[2]", "normal"});
  tangents.pop_back();
  expect_message<ArgumentError>(run, {"tangents has 2", "samples has 3"});
}

}  // namespace
}  // namespace dapple::test
