// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/planar.hpp>
#include <dapple/stipple.hpp>
#include <limits>
#include <numeric>

#include "base/random.hpp"
#include "stipple/error_diffusion.hpp"
#include "stipple/pixel_integrals.hpp"
#include "stipple/raster_domain.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kLambda = 30.0;

Image filled(std::size_t rows, std::size_t columns, double value) {
  return {rows, columns, std::vector<double>(rows * columns, value)};
}

/// Waves that are darkest in the middle, with a white frame.
Image waves(std::size_t rows, std::size_t columns) {
  Image image = filled(rows, columns, 0.0);
  for (std::size_t r = 2; r + 2 < rows; ++r)
    for (std::size_t c = 2; c + 2 < columns; ++c)
      image.values[r * columns + c] = 0.5 + 0.5 * std::sin(0.2 * static_cast<double>(r)) *
                                                std::cos(0.13 * static_cast<double>(c));
  return image;
}

Image noise(std::size_t rows, std::size_t columns, std::uint64_t seed) {
  Image image = filled(rows, columns, 0.0);
  Random random(seed);
  for (double& value : image.values) value = random.uniform();
  return image;
}

Sites random_sites(const RasterDomain& domain, const Image& image, std::size_t count) {
  Random random(7);
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = random.uniform() * static_cast<double>(image.columns);
    points.emplace_back(x, random.uniform() * static_cast<double>(image.rows), 0.0);
  }
  return domain.project(points, {});
}

std::vector<std::size_t> counts_of(const Stipples& dots, std::size_t classes) {
  std::vector<std::size_t> counts(classes, 0);
  for (const std::int32_t c : dots.classes) ++counts[static_cast<std::size_t>(c)];
  return counts;
}

// ---- cells in a picture ----

/// A flat mesh with a face of constant density for every pixel, to compare with the general
/// implementation.
Surface mesh_of(const Image& image) {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<double> density;
  const std::size_t across = image.columns + 1;
  for (std::size_t r = 0; r <= image.rows; ++r)
    for (std::size_t c = 0; c < across; ++c)
      vertices.emplace_back(static_cast<double>(c), static_cast<double>(r), 0.0);
  for (std::size_t r = 0; r < image.rows; ++r)
    for (std::size_t c = 0; c < image.columns; ++c) {
      const auto a = static_cast<std::int32_t>(r * across + c);
      const auto up = static_cast<std::int32_t>(across);
      faces.push_back({a, a + 1, a + up + 1});
      faces.push_back({a, a + up + 1, a + up});
      density.insert(density.end(), 2, image.values[r * image.columns + c]);
    }
  return {vertices, faces, {DensityAt::kFaces, density}};
}

TEST(StippleCells, AgreeWithTheFlatMesh) {
  const Image image = noise(9, 13, 1);
  const RasterDomain domain(image);
  const Sites sites = random_sites(domain, image, 40);
  const Surface surface = mesh_of(image);
  const Sites there = SurfaceDomain(surface).project(sites.positions, {});
  const Energy expected = evaluate_energy(surface, there, kLambda, Cells::kEuclidean);
  const Energy found = evaluate_energy(domain, sites, kLambda);
  EXPECT_NEAR(found.total, expected.total, 1e-10 * expected.total);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Moments &a = found.diagram.cells[k], &b = expected.diagram.cells[k];
    EXPECT_NEAR(a.area, b.area, 1e-10);
    EXPECT_NEAR(a.capacity, b.capacity, 1e-10);
    EXPECT_NEAR(a.mass, b.mass, 1e-10);
    EXPECT_NEAR((a.first - b.first).norm(), 0.0, 1e-10);
    EXPECT_NEAR(a.second, b.second, 1e-9);
    EXPECT_NEAR((found.gradient[k] - expected.gradient[k]).norm(), 0.0, 1e-8) << k;
    EXPECT_EQ(found.diagram.boundary(k).size(), expected.diagram.boundary(k).size());
  }
}

TEST(StippleCells, HaveTheGradientOfTheEnergy) {
  const Image image = noise(12, 10, 2);
  const RasterDomain domain(image);
  const Sites sites = random_sites(domain, image, 25);
  const Energy energy = evaluate_energy(domain, sites, kLambda);
  double largest = 0.0;
  for (const Vec3& g : energy.gradient) largest = std::max(largest, g.norm());
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < sites.size(); ++k)
    for (int axis = 0; axis < 2; ++axis) {
      Sites moved = sites;
      moved.positions[k][axis] += kStep;
      const double after = evaluate_energy(domain, moved, kLambda).total;
      moved.positions[k][axis] -= 2.0 * kStep;
      const double slope = (after - evaluate_energy(domain, moved, kLambda).total) / (2.0 * kStep);
      EXPECT_NEAR(slope, energy.gradient[k][axis], 1e-6 * largest) << k << ", " << axis;
    }
}

TEST(StippleCells, CoverThePictureEvenIfSitesCoincideOrLieOnPixelBorders) {
  const Image image = waves(20, 30);
  const RasterDomain domain(image);
  Sites sites = random_sites(domain, image, 20);
  sites.positions[3] = sites.positions[7] = sites.positions[11];
  for (int k = 0; k < 9; ++k)
    sites.positions[12 + static_cast<std::size_t>(k) % 8] = {4.0 + 2 * k, 6.0, 0.0};
  const RestrictedVoronoi diagram = domain.cells(sites, nullptr);
  double area = 0.0, capacity = 0.0;
  for (const Moments& cell : diagram.cells) {
    area += cell.area;
    capacity += cell.capacity;
  }
  EXPECT_NEAR(area, 600.0, 1e-9);
  EXPECT_NEAR(capacity, domain.capacity(), 1e-9);
  EXPECT_GT(diagram.cells[3].area, 0.0);
  EXPECT_EQ(diagram.cells[7].area, 0.0);
  EXPECT_EQ(diagram.cells[11].area, 0.0);
}

/// Sites without a cell overwrite all previous values.
TEST(StippleCells, OverwriteOthers) {
  const Image image = waves(20, 30);
  const RasterDomain domain(image);
  Sites sites = random_sites(domain, image, 20);
  RestrictedVoronoi kept = domain.cells(sites, nullptr);
  sites.positions[3] = sites.positions[7] = sites.positions[11];
  domain.update_cells(kept, sites, 0, nullptr);
  const RestrictedVoronoi fresh = domain.cells(sites, nullptr);
  ASSERT_EQ(kept.boundaries.size(), fresh.boundaries.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    EXPECT_EQ(kept.cells[k].capacity, fresh.cells[k].capacity) << k;
    EXPECT_EQ(kept.rows[k].first, fresh.rows[k].first) << k;
    EXPECT_EQ(kept.rows[k].count, fresh.rows[k].count) << k;
  }
}

TEST(StippleCells, ProjectionEndsAtTheNearestInk) {
  Image image = filled(10, 10, 0.0);
  image.values[2 * 10 + 3] = 1.0;
  image.values[8 * 10 + 8] = 0.5;
  const RasterDomain domain(image);
  const std::vector<Vec3> points = {{0, 0, 0}, {3.5, 2.25, 0}, {30, 30, 0}, {6.4, 2.5, 0}};
  const Sites sites = domain.project(points, {});
  const std::vector<Vec3> expected = {{3, 2, 0}, {3.5, 2.25, 0}, {9, 9, 0}, {4, 2.5, 0}};
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3& found = sites.positions[k];
    EXPECT_LE((found - expected[k]).norm(), 1e-12) << k;
    // The end of a pixel is the beginning of the next one, which may have no ink.
    const auto column = static_cast<std::size_t>(found.x()),
               row = static_cast<std::size_t>(found.y());
    EXPECT_GT(image.values[10 * row + column], 0.0) << k;
  }
}

// ---- the start ----

TEST(StippleStart, DiffusesExactlyTheCounts) {
  const Image image = waves(40, 50), other = noise(40, 50, 3);
  for (const std::size_t count : {1u, 2u, 37u, 500u, 5000u}) {
    const std::vector<Image> inks = {image, other, filled(40, 50, 0.0)};
    const std::vector<std::size_t> counts = {count, 2 * count, 0};
    const Diffused dots = diffuse_errors(inks, counts, 5);
    ASSERT_EQ(dots.positions.size(), 3 * count);
    EXPECT_EQ(std::count(dots.classes.begin(), dots.classes.end(), 0),
              static_cast<std::ptrdiff_t>(count));
    EXPECT_EQ(std::count(dots.classes.begin(), dots.classes.end(), 1),
              static_cast<std::ptrdiff_t>(2 * count));
  }
}

TEST(StippleStart, FollowsTheDensity) {
  Image image = filled(64, 64, 0.1);
  for (std::size_t k = 0; k < 32 * 64; ++k) image.values[k] = 0.9;
  const std::vector<std::size_t> counts = {1000};
  const Diffused dots = diffuse_errors({&image, 1}, counts, 0);
  const auto dark = std::count_if(dots.positions.begin(), dots.positions.end(),
                                  [](const Vec2& x) { return x.y() < 32.0; });
  EXPECT_NEAR(static_cast<double>(dark), 900.0, 5.0);
}

// ---- dots ----

TEST(Stipple, HasTheRequestedCountOfDotsOnInk) {
  const Image image = waves(40, 60);
  for (const std::size_t count : {1u, 2u, 3u, 50u, 1000u}) {
    const Stipples dots = stipple_inks({&image, 1}, count);
    ASSERT_EQ(dots.positions.size(), count);
    EXPECT_EQ(dots.report.count, count);
    for (const Vec2& x : dots.positions) {
      EXPECT_GE(x.minCoeff(), 2.0);
      EXPECT_LE(x.x(), 58.0);
      EXPECT_LE(x.y(), 38.0);
    }
  }
}

TEST(Stipple, IsEven) {
  const Image image = waves(80, 100);
  const Stipples dots = stipple_inks({&image, 1}, 800);
  EXPECT_LT(dots.report.evenness.capacity_variation, 0.02);
  EXPECT_GT(dots.report.evenness.alpha_mean, 0.75);
  EXPECT_TRUE(dots.report.converged);
}

TEST(Stipple, GivesTheSameBytesForAnyThreads) {
  const std::array<Image, 2> inks = {waves(40, 60), noise(40, 60, 4)};
  const Stipples base = stipple_inks(inks, 300, {.seed = 3, .threads = 1});
  const Stipples again = stipple_inks(inks, 300, {.seed = 3, .threads = 2});
  EXPECT_EQ(base.positions, again.positions);
  EXPECT_EQ(base.classes, again.classes);
  EXPECT_NE(base.positions, stipple_inks(inks, 300, {.seed = 4}).positions);
}

TEST(Stipple, OfAnAllBlackPictureIsEven) {
  const Image image = filled(20, 30, 1.0);
  const Stipples dots = stipple_inks({&image, 1}, 200);
  EXPECT_LT(dots.report.evenness.capacity_variation, 0.02);
  EXPECT_NEAR(dots.radius, std::sqrt(600.0 / (200.0 * 3.14159265358979)), 1e-9);
}

TEST(Stipple, OfOnePixel) {
  const Image image = filled(1, 1, 0.5);
  const Stipples dots = stipple_inks({&image, 1}, 30);
  ASSERT_EQ(dots.positions.size(), 30u);
  for (const Vec2& x : dots.positions) {
    EXPECT_GE(x.minCoeff(), 0.0);
    EXPECT_LE(x.maxCoeff(), 1.0);
  }
  EXPECT_LT(dots.report.evenness.capacity_variation, 0.05);
}

TEST(Stipple, AllotsInksByTheirSums) {
  const std::vector<Image> inks = {filled(8, 8, 0.5), filled(8, 8, 0.0), filled(8, 8, 0.25),
                                   filled(8, 8, 0.25)};
  EXPECT_EQ(counts_of(stipple_inks(inks, 101), 4), (std::vector<std::size_t>{51, 0, 25, 25}));
  StippleOptions options;
  options.counts = {1, 0, 60, 40};
  EXPECT_EQ(counts_of(stipple_inks(inks, 101, options), 4), options.counts);
}

TEST(Stipple, InksAreEvenByThemselvesAndTogether) {
  const std::vector<Image> inks = {filled(30, 40, 0.5), waves(30, 40)};
  const Stipples dots = stipple_inks(inks, 800);
  EXPECT_LT(dots.report.evenness.capacity_variation, 0.05);
  for (const Quality& one : dots.report.classes) EXPECT_LT(one.evenness.capacity_variation, 0.06);
}

TEST(Stipple, InksNeedNotBeEvenTogether) {
  StippleOptions options;
  options.union_weight = 0.0;
  const std::vector<Image> inks = {waves(8, 8), noise(8, 8, 3)};
  const Stipples dots = stipple_inks(inks, 20, options);
  EXPECT_EQ(dots.positions.size(), 20u);
}

TEST(StippleCells, ProjectionNamesWhatIsNotFinite) {
  const RasterDomain domain(noise(4, 4, 1));
  const std::vector<Vec3> points = {{1, 1, 0}, {std::nan(""), 1, 0}};
  expect_message<ArgumentError>([&] { (void)domain.project(points, {}); }, {"points[1]"});
}

TEST(Stipple, StopsWhenCancelled) {
  const Image image = waves(40, 60);
  Context context;
  context.cancel();
  EXPECT_THROW((void)stipple_inks({&image, 1}, 50, {}, &context), Cancelled);
}

TEST(Stipple, NamesWhatIsWrong) {
  const auto fails = [](std::vector<Image> inks, std::size_t count, const StippleOptions& options,
                        std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>([&] { (void)stipple_inks(inks, count, options); }, parts);
  };
  fails({filled(4, 5, 0.0)}, 10, {}, {"white", "no dots can be placed"});
  fails({filled(4, 5, 1.0)}, 0, {}, {"count is 0"});
  fails({}, 10, {}, {"inks is empty"});
  fails({filled(0, 5, 1.0)}, 10, {}, {"inks[0]", "at least one pixel"});
  fails({filled(4, 5, 1.0), filled(5, 4, 1.0)}, 10, {}, {"inks[1]", "5 x 4", "4 x 5"});
  Image bad = filled(4, 5, 0.5);
  bad.values[7] = std::numeric_limits<double>::quiet_NaN();
  fails({bad}, 10, {}, {"inks[0][1, 2]", "nan"});
  bad.values[7] = -0.5;
  fails({bad}, 10, {}, {"inks[0][1, 2]", "-0.5"});
  fails({filled(4, 5, 1.0)}, 10, {.radius = -1.0}, {"radius is -1"});
  fails({filled(4, 5, 1.0)}, 10, {.counts = {9}}, {"counts sum to 9", "10"});
  fails({filled(4, 5, 1.0), filled(4, 5, 0.0)}, 10, {.counts = {5, 5}}, {"counts[1] is 5"});
  fails({filled(4, 5, 1.0)}, 10, {.counts = {5, 5}}, {"counts", "inks"});
}

// ---- color ----

TEST(StippleInks, RecomposeThePicture) {
  const ColorImage picture = {noise(20, 20, 1), noise(20, 20, 2), noise(20, 20, 3)};
  const std::array<Image, kInks> inks = separate_inks(picture);
  const ColorImage mixed = mix_inks(inks);
  for (std::size_t p = 0; p < 400; ++p) {
    double all = 0.0;
    int present = 0;
    for (const Image& ink : inks) {
      EXPECT_GE(ink.values[p], 0.0);
      all += ink.values[p];
      present += ink.values[p] > 0.0 ? 1 : 0;
    }
    EXPECT_LE(all, 1.0);
    EXPECT_LE(present, 3);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(mixed[k].values[p], picture[k].values[p], 1e-12);
  }
}

TEST(StippleInks, ArePureForPureColors) {
  // one pixel of each ink, then white
  const ColorImage picture = {Image{1, 8, {1, 0, 0, 0, 1, 1, 0, 1}},
                              Image{1, 8, {0, 1, 0, 1, 0, 1, 0, 1}},
                              Image{1, 8, {0, 0, 1, 1, 1, 0, 0, 1}}};
  const std::array<Image, kInks> inks = separate_inks(picture);
  for (std::size_t p = 0; p < 8; ++p)
    for (std::size_t c = 0; c < kInks; ++c)
      EXPECT_EQ(inks[c].values[p], p == c ? 1.0 : 0.0) << p << ", " << c;
}

TEST(StippleInks, NameWhatIsWrong) {
  ColorImage picture = {noise(4, 4, 1), noise(4, 4, 2), noise(4, 4, 3)};
  picture[1].values[6] = 1.5;
  expect_message<ArgumentError>([&] { (void)separate_inks(picture); },
                                {"green[6]", "1.5", "[0, 1]"});
  picture[1] = noise(4, 5, 2);
  expect_message<ArgumentError>([&] { (void)separate_inks(picture); }, {"green", "4 x 5"});
}

}  // namespace
}  // namespace dapple::test
