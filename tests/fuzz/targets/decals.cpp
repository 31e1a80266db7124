// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/decals.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

std::vector<FaceUv> take_uv(Bytes& bytes, const Surface& surface) {
  std::vector<FaceUv> uv(surface.face_count());
  const bool wide = bytes.one_in(4);
  test::Random random(bytes.byte());
  for (FaceUv& row : uv)
    for (Vec2& corner : row) {
      const double u = random.uniform();
      corner = (wide ? 3.0 : 1.0) * Vec2(u, random.uniform());
    }
  if (bytes.one_in(8)) uv[bytes.whole() % uv.size()][0].x() = bytes.wild();
  return uv;
}

Texels take_texels(Bytes& bytes, const Surface& surface) {
  const std::vector<FaceUv> uv = take_uv(bytes, surface);
  const auto rows = static_cast<std::size_t>(bytes.below(24));
  const auto columns = static_cast<std::size_t>(bytes.below(24));
  return texels(surface, uv, rows, columns, bytes.between(-1, 8));
}

void expect_texels(const Surface& surface, const Texels& found) {
  EXPECT_EQ(found.faces.size(), found.rows * found.columns);
  EXPECT_EQ(found.barycentric.size(), found.faces.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_GE(found.faces[k], -1);
    EXPECT_LT(found.faces[k], static_cast<std::int32_t>(surface.face_count()));
    if (found.faces[k] >= 0) {
      EXPECT_NEAR(found.barycentric[k].sum(), 1.0, 1e-6);
    }
  }
}

void expect_cover(const DecalCover& covered, std::size_t texels, std::size_t samples) {
  ASSERT_EQ(covered.samples.size(), texels);
  ASSERT_EQ(covered.places.size(), texels);
  for (std::size_t k = 0; k < texels; ++k) {
    EXPECT_GE(covered.samples[k], -1);
    EXPECT_LT(covered.samples[k], static_cast<std::int32_t>(samples));
    if (covered.samples[k] >= 0) {
      EXPECT_LE(covered.places[k].cwiseAbs().maxCoeff(), 1.0 + 1e-12);
    }
  }
}

}  // namespace

void fuzz_decals(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const auto found = answer([&] { return take_texels(bytes, *surface); });
  if (!found) return;
  expect_texels(*surface, *found);
  const auto samples = take_samples(bytes, *surface, 20);
  if (!samples) return;
  std::vector<double> radii;
  std::vector<Vec3> tangents;
  test::Random random(bytes.byte());
  for (std::size_t k = 0; k < samples->size(); ++k) {
    radii.push_back(take_option(bytes, {}, 0.5 * surface->spacing(samples->size())));
    tangents.push_back(random.in_box());
  }
  const auto covered =
      answer([&] { return decal_cover(*surface, *samples, radii, tangents, *found); });
  if (covered) expect_cover(*covered, found->size(), samples->size());
}

}  // namespace dapple::fuzz
