// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/spectrum.hpp>
#include <limits>
#include <numbers>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Points = std::vector<Vec2>;
constexpr double kPi = std::numbers::pi;

Spectrum spectrum_of(const std::vector<Points>& runs, int half_width = 0, int threads = 0) {
  const std::vector<std::span<const Vec2>> spans(runs.begin(), runs.end());
  return spectrum(spans, {half_width, threads});
}

Points white_noise(std::size_t count, Random& random) {
  Points points;
  for (std::size_t k = 0; k < count; ++k) points.emplace_back(random.uniform(), random.uniform());
  return points;
}

std::vector<Points> white_runs(std::size_t runs, std::size_t count) {
  Random random(1);
  std::vector<Points> result;
  for (std::size_t k = 0; k < runs; ++k) result.push_back(white_noise(count, random));
  return result;
}

/// One point in each cell of a grid, displaced from the middle by up to half of `jitter` cells.
Points jittered_grid(int side, double jitter, Random& random) {
  Points points;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      points.emplace_back((column + 0.5 + jitter * random.between(-0.5, 0.5)) / side,
                          (row + 0.5 + jitter * random.between(-0.5, 0.5)) / side);
  return points;
}

/// Rows with alternating offset that close around the torus.
Points hexagons(int columns, int rows) {
  Points points;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      points.emplace_back((column + 0.5 * (row % 2)) / columns, static_cast<double>(row) / rows);
  return points;
}

double power(const Spectrum& s, int x, int y) {
  const int width = 2 * s.half_width + 1;
  return s.periodogram[static_cast<std::size_t>((y + s.half_width) * width + x + s.half_width)];
}

template <typename Visit>
void for_each_frequency(int half_width, const Visit& visit) {
  for (int y = -half_width; y <= half_width; ++y)
    for (int x = -half_width; x <= half_width; ++x) visit(x, y);
}

TEST(Spectrum, IsTheSquaredFourierSum) {
  Random random(3);
  const Points points = white_noise(40, random);
  const Spectrum found = spectrum_of({points}, 9);
  ASSERT_EQ(found.half_width, 9);
  for_each_frequency(9, [&](int x, int y) {
    std::complex<double> sum = 0.0;
    for (const Vec2& p : points) sum += std::polar(1.0, -2.0 * kPi * (x * p.x() + y * p.y()));
    EXPECT_NEAR(power(found, x, y), std::norm(sum) / 40.0, 1e-11);
  });
  EXPECT_NEAR(power(found, 0, 0), 40.0, 1e-12);
}

TEST(Spectrum, IsTheMeanOverTheRuns) {
  const std::vector<Points> runs = white_runs(3, 50);
  const Spectrum all = spectrum_of(runs, 12);
  EXPECT_EQ(all.runs, 3u);
  const Spectrum a = spectrum_of({runs[0]}, 12);
  const Spectrum b = spectrum_of({runs[1]}, 12);
  const Spectrum c = spectrum_of({runs[2]}, 12);
  for (std::size_t k = 0; k < all.periodogram.size(); ++k)
    EXPECT_NEAR(all.periodogram[k], (a.periodogram[k] + b.periodogram[k] + c.periodogram[k]) / 3.0,
                1e-11);
}

/// The power of white noise has the mean 1 and the variance 1 - 1/n at every frequency but 0.
TEST(Spectrum, OfWhiteNoiseIsOne) {
  for (const std::size_t runs : {1u, 10u}) {
    const Spectrum found = spectrum_of(white_runs(runs, 1000));
    EXPECT_EQ(found.half_width, 95);
    const RadialStatistics& radial = found.radial;
    ASSERT_EQ(radial.mean.size(), 95u);
    double variance = 0.0;
    for (std::size_t k = 0; k < radial.mean.size(); ++k) {
      EXPECT_EQ(radial.radius[k], static_cast<double>(k + 1));
      const double deviation = 1.0 / std::sqrt(static_cast<double>(runs) * kPi * radial.radius[k]);
      EXPECT_NEAR(radial.mean[k], 1.0, 5.0 * deviation) << k;
      if (k >= 9) variance += std::pow(10.0, radial.anisotropy[k] / 10.0) / 86.0;
    }
    EXPECT_NEAR(variance * static_cast<double>(runs), 1.0, 0.05);
  }
}

/// The expected power is 1 - s^2 with s = sinc sinc of the jitter, plus n s^2 at the frequencies of
/// the grid.
TEST(Spectrum, OfAJitteredGridIsAsExpected) {
  const int side = 12, runs = 400;
  for (const double jitter : {1.0, 0.5}) {
    Random random(5);
    std::vector<Points> sets;
    for (int k = 0; k < runs; ++k) sets.push_back(jittered_grid(side, jitter, random));
    const Spectrum found = spectrum_of(sets, 26);
    const auto sinc = [&](int f) {
      const double x = kPi * f * jitter / side;
      return f == 0 ? 1.0 : std::sin(x) / x;
    };
    for_each_frequency(26, [&](int x, int y) {
      const double s = sinc(x) * sinc(y);
      const bool of_grid = x % side == 0 && y % side == 0;
      const double expected = 1.0 - s * s + (of_grid ? side * side * s * s : 0.0);
      EXPECT_NEAR(power(found, x, y), expected, 6.0 * expected / std::sqrt(runs)) << x << ' ' << y;
    });
  }
}

TEST(Spectrum, OfASquareLatticeIsItsReciprocal) {
  Random random(1);
  const Spectrum found = spectrum_of({jittered_grid(16, 0.0, random)}, 50);
  for_each_frequency(50, [&](int x, int y) {
    EXPECT_NEAR(power(found, x, y), x % 16 == 0 && y % 16 == 0 ? 256.0 : 0.0, 1e-8);
  });
}

/// Peaks are where x is p times the columns and y is q halves of the rows with p + q even; six of
/// them are nearest to 0.
TEST(Spectrum, OfAHexagonalLatticeIsItsReciprocal) {
  const int columns = 12, rows = 14, half_width = 40;
  const Spectrum found = spectrum_of({hexagons(columns, rows)}, half_width);
  int nearest = 0;
  for_each_frequency(half_width, [&](int x, int y) {
    const bool peak =
        x % columns == 0 && y % (rows / 2) == 0 && (x / columns + y / (rows / 2)) % 2 == 0;
    EXPECT_NEAR(power(found, x, y), peak ? columns * rows : 0.0, 1e-8) << x << ' ' << y;
    nearest += peak && std::hypot(x, y) > 0.0 && std::hypot(x, y) < 15.0;
  });
  EXPECT_EQ(nearest, 6);
  const double unit = found.frequency_unit;
  EXPECT_NEAR(unit * std::sqrt(2.0 / std::numbers::sqrt3), 14.0, 0.2);
}

TEST(Spectrum, OfOnePointIsOneEverywhere) {
  const Spectrum found = spectrum_of({{Vec2(0.3, 0.8)}}, 7);
  for (const double value : found.periodogram) EXPECT_NEAR(value, 1.0, 1e-13);
  for (const double value : found.radial.mean) EXPECT_NEAR(value, 1.0, 1e-13);
}

/// Without variance there is no value in decibels.
TEST(Spectrum, WithoutVarianceHasNoAnisotropy) {
  const Spectrum found = spectrum_of({{Vec2(0.0, 0.0)}}, 7);
  for (const double value : found.radial.anisotropy)
    EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
}

TEST(Spectrum, IsFreeOfTranslationsOnTheTorus) {
  Random random(8);
  const Points points = white_noise(300, random);
  Points moved;
  for (const Vec2& p : points)
    moved.emplace_back(std::fmod(p.x() + 0.37, 1.0), std::fmod(p.y() + 0.81, 1.0));
  const Spectrum a = spectrum_of({points});
  const Spectrum b = spectrum_of({moved});
  for (std::size_t k = 0; k < a.periodogram.size(); ++k)
    EXPECT_NEAR(a.periodogram[k], b.periodogram[k], 1e-9);
}

TEST(Spectrum, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Points> runs = white_runs(3, 200);
  const Spectrum one = spectrum_of(runs, 0, 1);
  for (const int threads : {2, 5, 0}) {
    const Spectrum many = spectrum_of(runs, 0, threads);
    EXPECT_EQ(many.periodogram, one.periodogram);
    EXPECT_EQ(many.radial.anisotropy, one.radial.anisotropy);
  }
}

TEST(Spectrum, IsEqualAtOppositeFrequencies) {
  const Spectrum found = spectrum_of(white_runs(2, 100), 15);
  for_each_frequency(15,
                     [&](int x, int y) { EXPECT_EQ(power(found, x, y), power(found, -x, -y)); });
}

TEST(Spectrum, NamesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>([] { (void)spectrum_of({}); }, {"runs is empty"});
  expect_message<ArgumentError>([] { (void)spectrum_of({{Vec2(0, 0)}, {}}); },
                                {"runs[1]", "no points"});
  expect_message<ArgumentError>([&] { (void)spectrum_of({{Vec2(0, 0), Vec2(0.5, nan)}}); },
                                {"runs[0][1]", "coordinate 1", "nan"});
  expect_message<ArgumentError>([] { (void)spectrum_of({{Vec2(1.5, 0)}}); },
                                {"runs[0][0]", "unit square", "1.5"});
  expect_message<ArgumentError>([] { (void)spectrum_of({{Vec2(0, 0)}}, -1); },
                                {"half_width is -1"});
  expect_message<ArgumentError>([] { (void)spectrum_of({{Vec2(0, 0)}}, 10000); },
                                {"half_width is 10000"});
}

TEST(Spectrum, IsCancelledAndTellsItsProgress) {
  const Points points = white_runs(1, 100)[0];
  const std::vector<std::span<const Vec2>> runs = {points};
  Context context;
  (void)spectrum(runs, {}, &context);
  EXPECT_EQ(context.progress(), 1.0);
  context.cancel();
  EXPECT_THROW((void)spectrum(runs, {}, &context), Cancelled);
}

/// Barycentric coordinates of a point in the plane of a face.
Vec3 weights_in(const Shape& shape, std::int32_t face, const Vec3& p) {
  const Face& f = shape.faces[static_cast<std::size_t>(face)];
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k)
    corners.col(k) = shape.vertices[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])] +
                     Vec3(0.0, 0.0, 1.0);
  return corners.inverse() * (p + Vec3(0.0, 0.0, 1.0));
}

Samples bound(const Shape& shape, const Sites& sites) {
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Face& f = shape.faces[static_cast<std::size_t>(sites.faces[k])];
    const auto corner = [&](std::size_t c) {
      return shape.vertices[static_cast<std::size_t>(f[c])];
    };
    const Vec3 u = corner(1) - corner(0), v = corner(2) - corner(0), n = u.cross(v);
    const Vec3 w = sites.positions[k] - corner(0);
    const double b = w.cross(v).dot(n) / n.squaredNorm(), c = u.cross(w).dot(n) / n.squaredNorm();
    weights.push_back(Vec3(1.0 - b - c, b, c).cwiseMax(0.0));
  }
  return bind_samples(shape.surface(), sites.faces, weights);
}

SurfaceSpectrum spectrum_on(const Shape& shape, const std::vector<Samples>& runs,
                            const SurfaceSpectrumOptions& options = {}) {
  std::vector<const Samples*> pointers;
  for (const Samples& samples : runs) pointers.push_back(&samples);
  return surface_spectrum(shape.surface(), pointers, options);
}

std::vector<Samples> noise_on(const Shape& shape, std::size_t runs, std::size_t count) {
  Random random(21);
  std::vector<Samples> result;
  for (std::size_t k = 0; k < runs; ++k)
    result.push_back(bound(shape, random_sites(shape, count, random)));
  return result;
}

/// Rows of hexagons of distance 1 on a flat sheet.
struct Sheet {
  Shape shape;
  Samples samples;
};

Sheet hexagon_sheet(int columns, int rows) {
  const double height = rows * std::numbers::sqrt3 / 2.0;
  const Shape shape =
      mapped(grid(1), [&](const Vec3& p) { return Vec3(columns * p.x(), height * p.y(), 0.0); });
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec3 p(column + 0.25 + 0.5 * (row % 2), (row + 0.5) * std::numbers::sqrt3 / 2.0, 0.0);
      const std::int32_t face = weights_in(shape, 0, p).minCoeff() >= 0.0 ? 0 : 1;
      faces.push_back(face);
      weights.push_back(weights_in(shape, face, p).cwiseMax(0.0));
    }
  return {shape, bind_samples(shape.surface(), faces, weights)};
}

double relative_deviation(const SurfaceSpectrum& found, double r) {
  const double width = 2.0 * found.radius / found.bins;
  const double pairs = kPi * r * width * 2.0 / std::numbers::sqrt3;
  return 1.0 / std::sqrt(pairs * static_cast<double>(found.centers));
}

TEST(SurfaceSpectrum, OfWhiteNoiseInThePlaneIsOne) {
  const Shape shape = grid(1);
  const SurfaceSpectrum found = spectrum_on(shape, noise_on(shape, 20, 2000), {.bins = 64});
  EXPECT_EQ(found.runs, 20u);
  EXPECT_GT(found.centers, 20u * 2000u / 2u);
  const RadialStatistics& radial = found.radial_differentials;
  ASSERT_EQ(radial.mean.size(), 32u);
  for (std::size_t k = 0; k < radial.mean.size(); ++k)
    EXPECT_NEAR(radial.mean[k], 1.0, 6.0 * relative_deviation(found, radial.radius[k])) << k;
  for (const double value : found.radial_power.mean) EXPECT_NEAR(value, 1.0, 0.1);
}

/// A ring of geodesic radius t on the unit sphere has the length 2 pi sin t; with chord lengths the
/// ratio would be 1.
TEST(SurfaceSpectrum, MeasuresAlongTheSphere) {
  const Shape shape = icosphere(5);
  const SurfaceSpectrum found =
      spectrum_on(shape, noise_on(shape, 6, 1500), {.radius = 6.0, .bins = 32});
  EXPECT_EQ(found.centers, 6u * 1500u);
  const double spacing = shape.surface().spacing(1500);
  for (std::size_t k = 0; k < found.radial_differentials.mean.size(); ++k) {
    const double t = found.radial_differentials.radius[k] * spacing;
    EXPECT_NEAR(found.radial_differentials.mean[k], std::sin(t) / t,
                6.0 * relative_deviation(found, found.radial_differentials.radius[k]));
  }
  EXPECT_LT(found.radial_differentials.mean.back(), 0.965);
}

/// Differences of lattice points are lattice points.
TEST(SurfaceSpectrum, OfHexagonsIsTheirLattice) {
  const Sheet sheet = hexagon_sheet(40, 48);
  const SurfaceSpectrum found = spectrum_on(sheet.shape, {sheet.samples}, {.radius = 3.3});
  const double width = 2.0 * found.radius / found.bins;
  int occupied = 0;
  for (int y = 0; y < found.bins; ++y)
    for (int x = 0; x < found.bins; ++x) {
      const double ratio = found.differentials[static_cast<std::size_t>(y * found.bins + x)];
      if (!(ratio > 0.0)) continue;
      ++occupied;
      const Vec2 middle((x + 0.5) * width - found.radius, (y + 0.5) * width - found.radius);
      const double row = std::round(middle.y() * 2.0 / std::numbers::sqrt3);
      const double column = std::round(middle.x() - 0.5 * row) + 0.5 * row;
      EXPECT_NEAR(middle.y(), row * std::numbers::sqrt3 / 2.0, 0.5 * width + 1e-9);
      EXPECT_NEAR(middle.x(), column, 0.5 * width + 1e-9);
    }
  EXPECT_GE(occupied, 36);  // lattice points with 0 < r < 3.3
  const RadialStatistics& radial = found.radial_power;
  const auto peak = std::max_element(radial.mean.begin(), radial.mean.end()) - radial.mean.begin();
  EXPECT_NEAR(radial.radius[static_cast<std::size_t>(peak)], std::sqrt(2.0 / std::numbers::sqrt3),
              found.frequency_step);
  EXPECT_LT(radial.mean[2], 0.2);
}

/// White noise with a density, each pair measured relative to its own spacing.
TEST(SurfaceSpectrum, FollowsADensity) {
  const DensityFunction density = [](const Vec3& p) { return 1.0 + 3.0 * p.x(); };
  const Shape shape = with_density(grid(1), density);
  Random random(4);
  std::vector<Samples> runs;
  for (int run = 0; run < 10; ++run) {
    const Sites drawn = random_sites(shape, 5000, random);
    Sites kept;
    for (std::size_t k = 0; k < drawn.size(); ++k)
      if (4.0 * random.uniform() < density(drawn.positions[k])) {
        kept.positions.push_back(drawn.positions[k]);
        kept.faces.push_back(drawn.faces[k]);
      }
    runs.push_back(bound(shape, kept));
  }
  const SurfaceSpectrum found = spectrum_on(shape, runs, {.radius = 4.0, .bins = 32});
  const RadialStatistics& radial = found.radial_differentials;
  for (std::size_t k = 0; k < radial.mean.size(); ++k)
    EXPECT_NEAR(radial.mean[k], 1.0, 0.01 + 6.0 * relative_deviation(found, radial.radius[k]));
}

TEST(SurfaceSpectrum, OfOurSamplesIsBlue) {
  const Shape shape = torus(60, 24);
  const Samples samples = sample(shape.surface(), 1500);
  const SurfaceSpectrum found = spectrum_on(shape, {samples});
  const RadialStatistics& near = found.radial_differentials;
  for (std::size_t k = 0; near.radius[k] < 0.5; ++k) EXPECT_EQ(near.mean[k], 0.0);
  EXPECT_GT(*std::max_element(near.mean.begin(), near.mean.end()), 1.5);
  const RadialStatistics& radial = found.radial_power;
  for (std::size_t k = 2; radial.radius[k] < 0.5; ++k) EXPECT_LT(radial.mean[k], 0.3);
  const auto peak = std::max_element(radial.mean.begin(), radial.mean.end()) - radial.mean.begin();
  EXPECT_NEAR(radial.radius[static_cast<std::size_t>(peak)], 1.05, 0.15);
}

/// Samples on the front and back of a leaf do not count as pairs.
TEST(SurfaceSpectrum, KeepsToItsSheet) {
  const Sheet front = hexagon_sheet(24, 28);
  Shape back = mapped(front.shape, [](const Vec3& p) { return Vec3(p.x(), p.y(), -0.01); });
  for (Face& face : back.faces) std::swap(face[1], face[2]);
  const Shape leaf = joined(front.shape, back);
  std::vector<std::int32_t> faces = front.samples.faces;
  std::vector<Vec3> weights = front.samples.barycentric;
  for (std::size_t k = 0; k < front.samples.size(); ++k) {
    faces.push_back(front.samples.faces[k] + 2);
    weights.emplace_back(weights[k].x(), weights[k].z(), weights[k].y());
  }
  const Samples both = bind_samples(leaf.surface(), faces, weights);
  const SurfaceSpectrum one = spectrum_on(front.shape, {front.samples}, {.radius = 3.3});
  const SurfaceSpectrum two = spectrum_on(leaf, {both}, {.radius = 3.3});
  EXPECT_EQ(two.centers, 2 * one.centers);
  for (std::size_t k = 0; k < one.radial_differentials.mean.size(); ++k)
    EXPECT_NEAR(two.radial_differentials.mean[k], one.radial_differentials.mean[k],
                0.01 * one.radial_differentials.mean[k]);
}

TEST(SurfaceSpectrum, IsFreeOfTheUnit) {
  const Shape shape = blob(3);
  const Shape large = mapped(shape, [](const Vec3& p) { return Vec3(1024.0 * p); });
  const std::vector<Samples> small = noise_on(shape, 1, 400);
  const Samples scaled = bind_samples(large.surface(), small[0].faces, small[0].barycentric);
  EXPECT_EQ(spectrum_on(shape, small).radial_power.mean,
            spectrum_on(large, {scaled}).radial_power.mean);
}

TEST(SurfaceSpectrum, IsTheSameForAnyNumberOfThreads) {
  const Shape shape = blob(3);
  const std::vector<Samples> runs = noise_on(shape, 2, 500);
  const SurfaceSpectrum one = spectrum_on(shape, runs, {.threads = 1});
  for (const int threads : {2, 5, 0}) {
    const SurfaceSpectrum many = spectrum_on(shape, runs, {.threads = threads});
    EXPECT_EQ(many.power, one.power);
    EXPECT_EQ(many.radial_differentials.mean, one.radial_differentials.mean);
  }
}

TEST(SurfaceSpectrum, NamesBadInput) {
  const Shape shape = icosphere(2);
  const std::vector<Samples> runs = noise_on(shape, 2, 50);
  const auto of = [&](const std::vector<Samples>& sets,
                      const SurfaceSpectrumOptions& options = {}) {
    return [&shape, sets, options] { (void)spectrum_on(shape, sets, options); };
  };
  expect_message<ArgumentError>(of({}), {"runs is empty"});
  expect_message<ArgumentError>(of({runs[0], Samples()}), {"runs[1]", "0 samples"});
  expect_message<ArgumentError>(of(noise_on(shape, 1, 1)), {"runs[0]", "1 samples"});
  expect_message<ArgumentError>(of(runs, {.radius = 0.0}), {"radius is 0"});
  expect_message<ArgumentError>(of(runs, {.radius = std::nan("")}), {"radius is nan"});
  expect_message<ArgumentError>(of(runs, {.bins = 7}), {"bins is 7", "even"});
  const Shape sheet = grid(2);
  expect_message<ArgumentError>([&] { (void)spectrum_on(sheet, noise_on(sheet, 1, 20)); },
                                {"radius is 5", "border"});
  expect_message<ArgumentError>([&] { (void)spectrum_on(sheet, runs); }, {"runs[0].faces["});
}

}  // namespace
}  // namespace dapple::test
