// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstring>
#include <dapple/exposure.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>

#include "base/parallel.hpp"
#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

constexpr std::size_t kMostFaces = 3000;

Refined take_edges(Bytes& bytes, const Surface& surface) {
  std::vector<double> longest = {std::sqrt(surface.area()) * bytes.between(0.05, 1.0)};
  if (bytes.one_in(3)) longest.resize(surface.face_count(), longest[0]);
  if (bytes.one_in(6)) longest[bytes.whole() % longest.size()] = bytes.wild();
  return refine_edges(surface, longest, static_cast<std::size_t>(bytes.below(256)) * 8);
}

Refined take_picture(Bytes& bytes, const Surface& surface) {
  std::vector<FaceUv> uv(surface.face_count());
  test::Random random(bytes.byte());
  for (FaceUv& row : uv)
    for (Vec2& corner : row) {
      const double u = random.between(-0.2, 1.2);
      corner = {u, random.between(-0.2, 1.2)};
    }
  if (bytes.one_in(8)) uv[bytes.whole() % uv.size()][1].y() = bytes.wild();
  ImageOptions options;
  options.max_faces = kMostFaces;
  options.max_error = take_option(bytes, {0.0, kFinite, true}, 0.2);
  options.texels = take_option(bytes, {0.0, kFinite, true}, 1.0);
  options.repeat = bytes.one_in(2);
  return refine_image(surface, uv, take_image(bytes, 0.0), options);
}

Refined take_obstacles(Bytes& bytes, const Surface& surface) {
  const std::vector<Vec3> points = take_sites(bytes, surface, bytes.below(6)).positions;
  std::vector<double> radii;
  for (std::size_t k = 0; k < points.size(); ++k)
    radii.push_back(take_option(bytes, {0.0, kFinite, true}, 0.2 * std::sqrt(surface.area())));
  std::vector<std::uint8_t> areas;
  if (bytes.one_in(4))
    for (std::size_t f = 0; f < surface.face_count(); ++f) areas.push_back(bytes.byte() & 1);
  return refine_obstacles(surface, {points, radii, areas},
                          {.edge = bytes.between(0.1, 1.0), .max_faces = kMostFaces});
}

Refined take_outside(Bytes& bytes, const Surface& surface) {
  std::vector<std::vector<Vec3>> poses;
  while (poses.size() < 2 && bytes.one_in(3))
    poses.push_back(take_frame(bytes, surface.vertices()));
  return refine_outside(
      surface, {.openness = take_option(bytes, {0.0, 1.0}, 0.05),
                .edge = take_option(bytes, {0.0, kFinite, true}, 0.1 * std::sqrt(surface.area())),
                .max_faces = kMostFaces,
                .poses = std::move(poses)});
}

Refined take_refined(Bytes& bytes, const Surface& surface) {
  switch (bytes.below(4)) {
    case 0:
      return take_edges(bytes, surface);
    case 1:
      return take_picture(bytes, surface);
    case 2:
      return take_outside(bytes, surface);
    default:
      return take_obstacles(bytes, surface);
  }
}

/// The same faces in the same place, cut into smaller ones.
void expect_refined(const Refined& refined) {
  const Surface& fine = refined.surface;
  const double rounding = 1e-9 * refined.original.area() + area_rounding(refined.original);
  EXPECT_NEAR(fine.area(), refined.original.area(), rounding);
  ASSERT_EQ(refined.parents.size(), fine.face_count());
  ASSERT_EQ(refined.barycentric.size(), fine.face_count());
  ASSERT_EQ(refined.original.vertex_count() + refined.ends.size(), fine.vertex_count());
  for (std::size_t f = 0; f < fine.face_count(); ++f) {
    ASSERT_GE(refined.parents[f], 0);
    ASSERT_LT(static_cast<std::size_t>(refined.parents[f]), refined.original.face_count());
    for (const Vec3& corner : refined.barycentric[f]) {
      EXPECT_GE(corner.minCoeff(), 0.0);
      EXPECT_NEAR(corner.sum(), 1.0, 1e-12);
    }
  }
}

void expect_way_back(const Refined& refined, const Samples& fine) {
  const Samples coarse = to_original(refined, fine);
  test::check_on_surface(refined.original, {coarse.positions, coarse.faces}, coarse.barycentric);
  EXPECT_EQ(coarse.ids, fine.ids);
  const Samples again = from_original(refined, coarse);
  test::check_on_surface(refined.surface, {again.positions, again.faces}, again.barycentric);
}

}  // namespace

void fuzz_refine(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const Bytes before = bytes;
  const auto refined = answer_of_threads([&](int threads) {
    bytes = before;
    return with_threads(threads, [&] { return take_refined(bytes, *surface); });
  });
  if (!refined) return;
  expect_refined(*refined);
  if (const auto fine = take_samples(bytes, refined->surface, 20)) {
    const auto valid = answer([&] { return to_original(*refined, *fine); });
    if (valid) expect_way_back(*refined, *fine);
  }
  const auto samples = answer([&] { return sample(refined->surface, 10); });
  if (samples) expect_samples(refined->surface, *samples, 10);
}

}  // namespace dapple::fuzz
