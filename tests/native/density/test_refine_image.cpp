// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using PictureFunction = std::function<double(double, double)>;

Image picture(std::size_t rows, std::size_t columns, const PictureFunction& value) {
  Image image{rows, columns, {}};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      image.values.push_back(value((static_cast<double>(c) + 0.5) / static_cast<double>(columns),
                                   (static_cast<double>(r) + 0.5) / static_cast<double>(rows)));
  return image;
}

/// u = x, v = y.
std::vector<FaceUv> flat_uv(const Shape& shape) {
  std::vector<FaceUv> uv;
  for (const Face& face : shape.faces) {
    FaceUv row;
    for (std::size_t k = 0; k < 3; ++k)
      row[k] = shape.vertices[static_cast<std::size_t>(face[k])].head<2>();
    uv.push_back(row);
  }
  return uv;
}

/// An independent bilinear interpolation between the centers of pixels; beyond them the nearest
/// pixel counts.
double bilinear(const Image& image, double u, double v) {
  const auto along = [](double t, std::size_t count) {
    return std::clamp(t * static_cast<double>(count) - 0.5, 0.0, static_cast<double>(count) - 1.0);
  };
  const double x = along(u, image.columns), y = along(v, image.rows);
  double sum = 0.0;
  for (std::size_t r = 0; r < image.rows; ++r)
    for (std::size_t c = 0; c < image.columns; ++c)
      sum += image.values[r * image.columns + c] *
             std::max(0.0, 1.0 - std::abs(x - static_cast<double>(c))) *
             std::max(0.0, 1.0 - std::abs(y - static_cast<double>(r)));
  return sum;
}

/// The integral of the bilinear picture over the unit square. All pixels have the same weight,
/// because the hat functions at the border gain there what is cut off.
double integral(const Image& image) {
  return std::accumulate(image.values.begin(), image.values.end(), 0.0) /
         static_cast<double>(image.values.size());
}

Refined on_square(int cells, const Image& image, const ImageOptions& options = {}) {
  const Shape shape = grid(cells);
  return refine_image(shape.surface(), flat_uv(shape), image, options);
}

double hills(double u, double v) { return 1.0 + std::sin(9.0 * u) * std::cos(7.0 * v + 1.0); }
double disc(double u, double v) { return std::hypot(u - 0.4, v - 0.55) < 0.3 ? 1.0 : 0.0; }

struct Case {
  std::string name;
  Image image;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class RefineImageOf : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(
    Pictures, RefineImageOf,
    testing::Values(Case{"Ramp", picture(64, 64, [](double u, double) { return u * u; })},
                    Case{"Hills", picture(50, 80, hills)}, Case{"Disc", picture(100, 70, disc)},
                    Case{"Checks", picture(16, 16,
                                           [](double u, double v) {
                                             const int x = static_cast<int>(16 * u);
                                             return (x + static_cast<int>(16 * v)) % 2;
                                           })},
                    Case{"Dot", picture(64, 64,
                                        [](double u, double v) {
                                          return std::hypot(u - 0.2, v - 0.3) < 0.01 ? 1.0 : 0.001;
                                        })},
                    Case{"Row", picture(1, 40, hills)}, Case{"Pixel", {1, 1, {2.5}}}),
    shape_name<testing::TestParamInfo<Case>>);

TEST_P(RefineImageOf, HasTheMassOfThePicture) {
  const Image& image = GetParam().image;
  for (const int cells : {1, 3, 20}) {
    const Refined refined = on_square(cells, image);
    EXPECT_TRUE(refined.resolved);
    EXPECT_NEAR(refined.surface.capacity(), integral(image), 0.01 * integral(image));
  }
}

TEST_P(RefineImageOf, FollowsThePictureWithinTheToleranceOrAPixel) {
  const Image& image = GetParam().image;
  const double most = *std::max_element(image.values.begin(), image.values.end());
  const Refined refined = on_square(2, image);
  const Vec2 size(static_cast<double>(image.columns), static_cast<double>(image.rows));
  Random random(4);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(refined.surface.face_count()); ++f) {
    const OrderedFace ordered = refined.surface.ordered().ordered_face(f);
    const Face& corners = refined.surface.ordered().corners(ordered);
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 edge = (refined.surface.ordered().vertex(corners[(k + 1) % 3]) -
                         refined.surface.ordered().vertex(corners[k]))
                            .head<2>();
      longest = std::max(longest, edge.cwiseProduct(size).norm());
    }
    const Vec3 weights = random.weights();
    const Vec3 p = refined.surface.point(f, weights);
    const double off = std::abs(refined.surface.ordered().densities(ordered).dot(weights) -
                                bilinear(image, p.x(), p.y()));
    if (longest > 1.0) {
      ASSERT_LE(off, 0.025 * most) << "face " << f << ", " << longest << " pixels";
    }
  }
}

TEST(RefineImage, DoesNotCutALinearPicture) {
  const Image image = picture(40, 40, [](double u, double v) { return 2.0 + u - v; });
  const Shape inner =
      mapped(grid(2), [](const Vec3& p) { return Vec3(0.1 * p + Vec3(0.4, 0.4, 0)); });
  const Refined refined = refine_image(inner.surface(), flat_uv(inner), image);
  EXPECT_EQ(refined.surface.face_count(), 8u);
  EXPECT_NEAR(refined.surface.capacity(), 0.02, 1e-14);
}

TEST(RefineImage, CutsOnlyWhereThereIsDetail) {
  const Refined dot = on_square(1, picture(512, 512, [](double u, double v) {
                                  return std::hypot(u - 0.7, v - 0.3) < 0.01 ? 1.0 : 0.5;
                                }));
  EXPECT_TRUE(dot.resolved);
  EXPECT_LT(dot.surface.face_count(), 3000u);
  EXPECT_NEAR(dot.surface.capacity(), 0.5 + 0.5 * std::numbers::pi * 1e-4, 2e-6);
}

/// The quarters of the picture hold 10, 20, 30 and 40 % of its integral.
TEST(RefineImage, DoesNotCutShortEdgesOfTheSurface) {
  const Shape shape = grid(4);
  const Image stripes = picture(200, 200, [](double x, double) { return std::fmod(x * 50, 1.0); });
  ImageOptions options;
  options.shortest = 0.1 * std::sqrt(shape.surface().area());
  const std::size_t coarse =
      refine_image(shape.surface(), flat_uv(shape), stripes, options).parents.size();
  options.shortest *= 0.25;
  const std::size_t fine =
      refine_image(shape.surface(), flat_uv(shape), stripes, options).parents.size();
  EXPECT_GT(coarse, 100u);
  EXPECT_LT(coarse, 2'000u);
  EXPECT_GT(fine, 4 * coarse);
  options.shortest = -1.0;
  expect_message<ArgumentError>(
      [&] { (void)refine_image(shape.surface(), flat_uv(shape), stripes, options); },
      {"shortest is -1"});
}

TEST(RefineImage, PlacesSamplesInProportion) {
  const Image image = picture(64, 64, [](double u, double v) {
    return 1.0 + (u > 0.5 ? 1.0 : 0.0) + (v > 0.5 ? 2.0 : 0.0);
  });
  const Samples samples = sample(on_square(3, image).surface, 1000);
  std::array<int, 4> counts{};
  for (const Vec3& p : samples.positions)
    ++counts[(p.x() > 0.5 ? 1u : 0u) + (p.y() > 0.5 ? 2u : 0u)];
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(counts[k], 100.0 * static_cast<double>(k + 1), 8);
}

TEST(RefineImage, KeepsOffABlackHalf) {
  const Image image = picture(64, 64, [](double u, double) { return u < 0.5 ? 0.0 : 1.0; });
  const Refined refined = on_square(5, image);
  const Samples samples = to_original(refined, sample(refined.surface, 500));
  // The center of the last black pixel is half a pixel before the middle; a face may reach one
  // pixel farther.
  for (const Vec3& p : samples.positions) EXPECT_GE(p.x(), 0.5 - 1.5 / 64);
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.01);
  check_on_surface(refined.original, sites_of(samples), samples.barycentric);
}

/// The texture coordinates go from 0 to 1 around an open tube and jump back at a seam.
TEST(RefineImage, StaysConformingAtSeams) {
  const Shape shape = tube(12, 4);
  std::vector<FaceUv> uv;
  for (const Face& face : shape.faces) {
    FaceUv row;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = shape.vertices[static_cast<std::size_t>(face[k])];
      row[k] = {std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi), 0.5 * p.z() + 0.5};
    }
    for (std::size_t k = 1; k < 3; ++k) row[k].x() -= std::round(row[k].x() - row[0].x());
    const double turns = std::floor(row[0].x());
    for (Vec2& corner : row) corner.x() -= turns;
    uv.push_back(row);
  }
  const Image image = picture(60, 60, [](double u, double v) {
    return 1.0 + std::cos(2.0 * std::numbers::pi * (3.0 * u + v));
  });
  ImageOptions options;
  options.repeat = true;
  const Refined refined = refine_image(shape.surface(), uv, image, options);
  EXPECT_GT(refined.surface.face_count(), 4 * shape.faces.size());
  EXPECT_EQ(topology(refined.surface).border_loops, 2);
  EXPECT_NEAR(refined.surface.capacity(), shape.area(), 0.01 * shape.area());
  // The picture is periodic, so the density is continuous across the seam.
  std::map<std::int32_t, double> at_vertex;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(refined.surface.face_count()); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const double value =
          refined.surface.ordered().densities(OrderedFace{f})[static_cast<Eigen::Index>(k)];
      const auto known =
          at_vertex.try_emplace(refined.surface.ordered().corners(OrderedFace{f})[k], value).first;
      ASSERT_NEAR(known->second, value, 1e-9);
    }
}

TEST(RefineImage, RepeatsThePicture) {
  const Shape shape = grid(1);
  std::vector<FaceUv> uv = flat_uv(shape);
  for (FaceUv& row : uv)
    for (Vec2& corner : row) corner = 3.0 * corner - Vec2(1.25, 0.5);
  const Image image = picture(20, 30, hills);
  ImageOptions options;
  options.repeat = true;
  const double repeated = refine_image(shape.surface(), uv, image, options).surface.capacity();
  EXPECT_NEAR(repeated, integral(image), 0.01 * integral(image));
  options.repeat = false;
  const double clamped = refine_image(shape.surface(), uv, image, options).surface.capacity();
  EXPECT_GT(std::abs(clamped - repeated), 0.015 * repeated);
}

TEST(RefineImage, MultipliesTheDensityOfTheSurface) {
  const Shape shape = with_density(grid(1), [](const Vec3& p) { return p.x(); });
  const Image image = picture(64, 64, [](double u, double) { return u; });
  ImageOptions fine;
  fine.max_error = 1e-3;
  const Refined refined = refine_image(shape.surface(), flat_uv(shape), image, fine);
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(refined.surface.face_count()); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = refined.surface.ordered()
                           .vertex(refined.surface.ordered().corners(OrderedFace{f})[k])
                           .x();
      EXPECT_NEAR(refined.surface.ordered().densities(OrderedFace{f})[static_cast<Eigen::Index>(k)],
                  x * std::clamp(x, 0.5 / 64, 63.5 / 64), 1e-12);
    }
}

TEST(RefineImage, SaysWhenFacesAreTooFew) {
  ImageOptions options;
  options.max_faces = 500;
  const Refined refined = on_square(2, picture(200, 200, disc), options);
  EXPECT_FALSE(refined.resolved);
  EXPECT_LE(refined.surface.face_count(), 500u);
}

TEST(RefineImage, NamesTheFirstOffender) {
  const Shape shape = grid(2);
  const Surface surface = shape.surface();
  std::vector<FaceUv> uv = flat_uv(shape);
  const Image image = picture(4, 5, hills);
  Image bad = image;
  bad.values[13] = -0.5;
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, bad); },
                                {"image[2, 3]", "-0.5"});
  bad.values.assign(20, 0.0);
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, bad); },
                                {"image", "0 every"});
  ImageOptions options;
  options.max_error = 0.0;
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, image, options); },
                                {"max_error", "0"});
  options = {};
  options.texels = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, image, options); },
                                {"texels", "nan"});
  uv[5][1].y() = std::numeric_limits<double>::infinity();
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, image); },
                                {"uv[5, 1]", "inf"});
  uv[5][1].y() = -2e6;
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, image); },
                                {"uv[5, 1]", "-2000000"});
  uv.pop_back();
  expect_message<ArgumentError>([&] { (void)refine_image(surface, uv, image); }, {"uv", "7", "8"});
}

TEST(RefineImage, RefusesAnImageThatIsBlackOnTheWholeSurface) {
  const Image image = picture(32, 32, [](double u, double) { return u > 0.9 ? 1.0 : 0.0; });
  const Shape dark = mapped(grid(2), [](const Vec3& p) { return Vec3(0.5 * p); });
  expect_message<SurfaceError>([&] { (void)refine_image(dark.surface(), flat_uv(dark), image); },
                               {"density is 0"});
}

}  // namespace
}  // namespace dapple::test
