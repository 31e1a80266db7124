// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/planar_sampler.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "brute_force.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kLambda = 30.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Points = std::vector<Vec2>;

const Points kOutline = {{0, 0}, {3, 0}, {3, 2}, {1.5, 0.7}, {0, 2}};  // with a notch
const std::vector<Points> kHoles = {{{0.4, 0.4}, {0.4, 0.9}, {0.9, 0.4}},
                                    {{2.2, 0.3}, {2.6, 0.3}, {2.6, 0.8}, {2.2, 0.8}}};

Plane notched() { return Plane::polygon(kOutline, kHoles); }

Image wavy(std::size_t rows, std::size_t columns) {
  Image image{rows, columns, {}};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      image.values.push_back(1.2 + std::sin(1.0 + 2.0 * double(r)) * std::cos(3.0 * double(c)));
  return image;
}

Points random_points(std::size_t count, double width, double height, std::uint64_t seed) {
  Random random(seed);
  Points points;
  while (points.size() < count)
    points.emplace_back(random.between(0, width), random.between(0, height));
  return points;
}

double largest(const std::vector<Vec3>& vectors) {
  double result = 0.0;
  for (const Vec3& v : vectors) result = std::max(result, v.cwiseAbs().maxCoeff());
  return result;
}

void expect_near(const Energy& a, const Energy& b, double tolerance) {
  EXPECT_NEAR(a.total, b.total, tolerance * b.total);
  EXPECT_NEAR(a.cvt, b.cvt, tolerance * b.cvt);
  EXPECT_NEAR(a.capacity_term, b.capacity_term, tolerance * b.capacity_term);
  ASSERT_EQ(a.gradient.size(), b.gradient.size());
  const double scale = largest(b.gradient) + std::numeric_limits<double>::min();
  for (std::size_t k = 0; k < a.gradient.size(); ++k)
    EXPECT_LE((a.gradient[k] - b.gradient[k]).norm(), tolerance * scale) << "site " << k;
}

// ---- the plane against the same domain as a flat mesh ----

struct Case {
  std::string name;
  Plane domain;
};
void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

class PlaneCase : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Domains, PlaneCase,
                         testing::Values(Case{"Rectangle", Plane::rectangle(3, 2)},
                                         Case{"Polygon", notched()},
                                         Case{"Image", Plane::image(3, 2, wavy(7, 9))},
                                         Case{"OnePixel", Plane::image(3, 2, {1, 1, {2.5}})},
                                         Case{"Row", Plane::image(3, 2, wavy(1, 5))}),
                         shape_name<testing::TestParamInfo<Case>>);

void expect_as_mesh(const Plane& domain, const Sites& sites) {
  const Energy flat = evaluate_energy(domain, sites, kLambda);
  expect_near(flat, evaluate_energy(domain.surface(), sites, kLambda, Cells::kConnected), 1e-9);
  expect_near(evaluate_energy(*domain.with_cells(Cells::kEuclidean), sites, kLambda),
              evaluate_energy(domain.surface(), sites, kLambda, Cells::kEuclidean), 1e-9);
  double area = 0.0, capacity = 0.0;
  for (const Moments& cell : flat.diagram.cells) {
    area += cell.area;
    capacity += cell.capacity;
  }
  if (sites.size() == 0) return;
  EXPECT_NEAR(area, domain.area(), 1e-10 * domain.area());
  EXPECT_NEAR(capacity, domain.capacity(), 1e-10 * domain.capacity());
}

TEST_P(PlaneCase, AgreesWithTheFlatMesh) {
  const Plane& domain = GetParam().domain;
  for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 10u, 60u, 1000u})
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      expect_as_mesh(domain, domain.start(Start::kRandom, count, seed, nullptr));
}

/// The first of coincident sites only; `kept` receives their indices.
Sites without_twins(const Sites& sites, std::vector<std::size_t>& kept) {
  Sites result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto& known = result.positions;
    if (std::find(known.begin(), known.end(), sites.positions[k]) != known.end()) continue;
    kept.push_back(k);
    result.positions.push_back(sites.positions[k]);
    result.faces.push_back(sites.faces[k]);
  }
  return result;
}

TEST_P(PlaneCase, AgreesWithTheFlatMeshAtDegenerateSites) {
  const Plane& domain = GetParam().domain;
  const Surface& surface = domain.surface();
  const Shape shape{"", surface.vertices(), surface.faces(), surface.density()};
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const Sites sites = degenerate_sites(shape, 1 + seed, random);
    std::vector<std::size_t> kept;
    const Sites distinct = without_twins(sites, kept);
    expect_as_mesh(domain, distinct);

    const Energy expected = evaluate_energy(domain, distinct, kLambda);
    Energy all = evaluate_energy(domain, sites, kLambda);
    std::vector<Vec3> leading;
    for (const std::size_t k : kept)
      leading.push_back(std::exchange(all.gradient[k], Vec3::Zero()));
    EXPECT_EQ(largest(all.gradient), 0.0);
    all.gradient = leading;
    expect_near(all, expected, 1e-12);
  }
}

TEST_P(PlaneCase, HandlesSitesOnLinesAndCircles) {
  const Plane& domain = GetParam().domain;
  Points line, circle, lattice, same(5, Vec2(1.5, 0.35));
  for (int k = 0; k < 7; ++k) line.emplace_back(0.1 + 0.4 * k, 0.25);
  for (int k = 0; k < 12; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / 12.0;
    circle.emplace_back(1.5 + 0.25 * std::cos(turn), 0.35 + 0.25 * std::sin(turn));
  }
  for (int k = 0; k < 25; ++k) lattice.emplace_back(1.0 + 0.25 * (k % 5), 0.0625 * (k / 5));
  for (const Points& points : {line, circle, lattice, same})
    expect_as_mesh(domain, domain.sites(points));
}

TEST_P(PlaneCase, SamplesExactlyThatMany) {
  const Plane& domain = GetParam().domain;
  SampleOptions options;
  options.optimizer.max_evaluations = 10;
  for (const std::size_t count : {0u, 1u, 2u, 3u, 200u}) {
    const PlanarSamples samples = sample(domain, count, options);
    EXPECT_EQ(samples.positions.size(), count);
    EXPECT_EQ(samples.report.count, count);
    EXPECT_NO_THROW((void)domain.sites(samples.positions));
  }
}

TEST_P(PlaneCase, GivesTheSameBytesForAnyThreadsAndAgain) {
  const Plane& domain = GetParam().domain;
  SampleOptions options;
  options.optimizer.max_evaluations = 6;
  options.threads = 1;
  const PlanarSamples base = sample(domain, 150, options);
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    const PlanarSamples again = sample(domain, 150, options);
    EXPECT_EQ(again.positions, base.positions);
    EXPECT_EQ(again.report.energies, base.report.energies);
  }
}

TEST(Plane, MeasuresItsArea) {
  EXPECT_NEAR(Plane::rectangle(3, 2).area(), 6.0, 1e-14);
  EXPECT_NEAR(notched().area(), 6.0 - 1.95 - 0.125 - 0.2, 1e-13);
  Points turned(kOutline.rbegin(), kOutline.rend());
  EXPECT_NEAR(Plane::polygon(turned).area(), 4.05, 1e-13);
}

TEST(Plane, HasTheImagesMass) {
  EXPECT_NEAR(Plane::image(3, 2, {1, 1, {2.5}}).capacity(), 15.0, 1e-13);
  // The density is linear between the centers at 0.25 and 0.75 and constant beyond them.
  EXPECT_NEAR(Plane::image(1, 1, {1, 2, {0.0, 1.0}}).capacity(), 0.5, 1e-14);
}

TEST(Plane, HasTheEnergyOfFourSitesInASquare) {
  const Plane square = Plane::rectangle(1, 1);
  const Points points = {{0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}, {0.75, 0.75}};
  const Energy energy = evaluate_energy(square, square.sites(points), kLambda);
  EXPECT_NEAR(energy.cvt, 1.0 / 24.0, 1e-15);
  EXPECT_NEAR(energy.capacity_term, 0.25, 1e-15);
  EXPECT_LE(largest(energy.gradient), 1e-14);
}

TEST(Plane, KeepsOffHoles) {
  const Plane domain = notched();
  for (const Vec2& p : sample(domain, 300).positions)
    EXPECT_FALSE(p.x() > 2.2 + 1e-9 && p.x() < 2.6 - 1e-9 && p.y() > 0.3 + 1e-9 &&
                 p.y() < 0.8 - 1e-9);
}

TEST(Plane, FollowsAnImage) {
  const Plane ramp = Plane::image(1, 1, {1, 2, {0.0, 1.0}});
  std::size_t right = 0;
  for (const Vec2& p : sample(ramp, 400).positions) right += p.x() > 0.5 ? 1 : 0;
  EXPECT_NEAR(double(right), 350.0, 8.0);  // the right half has 7/8 of the integral
}

// ---- the torus ----

/// The square and its eight periodic images, as arrays.
Shape tiled(const Image* image) {
  const int columns = image ? int(image->columns) : 1, rows = image ? int(image->rows) : 1;
  Shape shape{"tiled", {}, {}, {}};
  const int across = 4 * columns;
  for (int r = 0; r <= 4 * rows; ++r)
    for (int c = 0; c <= across; ++c) {
      shape.vertices.emplace_back((c - 1.5 * columns + (columns % 2 ? 0.0 : 0.5)) / columns,
                                  (r - 1.5 * rows + (rows % 2 ? 0.0 : 0.5)) / rows, 0.0);
      if (!image) continue;
      const auto pixel = [](double x, int count) {
        return std::size_t((std::lround(x * count - 0.5) % count + count) % count);
      };
      shape.density.push_back(
          image->values[pixel(shape.vertices.back().y(), rows) * image->columns +
                        pixel(shape.vertices.back().x(), columns)]);
    }
  for (int r = 0; r < 4 * rows; ++r)
    for (int c = 0; c < across; ++c) {
      const std::int32_t a = r * (across + 1) + c, d = a + across + 1;
      shape.faces.push_back({a, a + 1, d + 1});
      shape.faces.push_back({a, d + 1, d});
    }
  return shape;
}

/// Compare with cells that all sites and their eight images cut by brute force.
void expect_tiled(const Torus& torus, const Image* image, const Points& points) {
  std::vector<Vec3> images;
  for (const int y : {0, -1, 1})
    for (const int x : {0, -1, 1})
      for (const Vec2& p : points) images.emplace_back(p.x() + x, p.y() + y, 0.0);
  const std::vector<BruteCell> expected = brute_force_cells(tiled(image), images);
  const RestrictedVoronoi found = torus.cells(torus.sites(points), nullptr);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Moments &a = found.cells[k], &b = expected[k].moments;
    EXPECT_NEAR(a.area, b.area, 1e-12);
    EXPECT_NEAR(a.capacity, b.capacity, 1e-12);
    EXPECT_NEAR(a.mass, b.mass, 1e-12);
    EXPECT_LE((a.first - b.first).norm(), 1e-12);
    EXPECT_NEAR(a.second, b.second, 1e-12);
    Vec3 flux = Vec3::Zero(), expected_flux = Vec3::Zero();
    double length = 0.0, expected_length = 0.0;
    for (const CellBoundary& side : found.boundary(k)) {
      flux += side.flux;
      length += side.length;
      const Vec2 there = points[std::size_t(side.neighbor)];
      const Vec2 turns = points[k] + side.offset.head<2>() - there;
      EXPECT_LE((turns - turns.array().round().matrix()).norm(), 1e-12);
    }
    for (const auto& [j, part] : expected[k].flux) expected_flux += part;
    for (const auto& [j, part] : expected[k].length) expected_length += part;
    EXPECT_LE((flux - expected_flux).norm(), 1e-11);
    EXPECT_NEAR(length, expected_length, 1e-11);
  }
}

TEST(Torus, AgreesWithATiling) {
  const Torus torus;
  for (const std::size_t count : {1u, 2u, 3u, 4u, 7u, 12u, 29u, 60u})
    for (std::uint64_t seed = 0; seed < 4; ++seed)
      expect_tiled(torus, nullptr, random_points(count, 1, 1, seed));
}

TEST(Torus, AgreesWithATilingUnderAnImage) {
  const std::pair<std::size_t, std::size_t> sizes[] = {{1, 1}, {1, 3}, {2, 2}, {3, 5}};
  for (const auto& [rows, columns] : sizes) {
    const Image image = wavy(rows, columns);
    const Torus torus(image);
    for (const std::size_t count : {1u, 2u, 3u, 8u, 40u})
      expect_tiled(torus, &image, random_points(count, 1, 1, count));
  }
}

TEST(Torus, AgreesWithATilingOfLattices) {
  for (const int side : {1, 2, 3, 8}) {
    Points points;
    for (int k = 0; k < side * side; ++k)
      points.emplace_back(double(k % side) / side, double(k / side) / side);
    expect_tiled(Torus(), nullptr, points);
    const RestrictedVoronoi cells = Torus().cells(Torus().sites(points), nullptr);
    for (const Moments& cell : cells.cells) EXPECT_NEAR(cell.area, 1.0 / (side * side), 1e-15);
  }
}

TEST(Torus, HandlesSitesOnOneLine) {
  Points points;
  for (int k = 0; k < 50; ++k) points.emplace_back(k / 50.0, 0.5);
  expect_tiled(Torus(), nullptr, points);
}

TEST(Torus, LeavesCoincidentSitesEmpty) {
  Points points = random_points(40, 1, 1, 3);
  points[30] = points[4];
  points[31] = points[4] + Vec2(1, -2);
  const RestrictedVoronoi found = Torus().cells(Torus().sites(points), nullptr);
  double area = 0.0;
  for (const Moments& cell : found.cells) area += cell.area;
  EXPECT_NEAR(area, 1.0, 1e-13);
  EXPECT_GT(found.cells[4].area, 0.0);
  EXPECT_EQ(found.cells[30].area, 0.0);
  EXPECT_LE(found.cells[31].area, 1e-12);
}

TEST(Torus, HoldsManySitesInOneCorner) {
  for (const double size : {0.3, 0.01}) {
    const RestrictedVoronoi found =
        Torus().cells(Torus().sites(random_points(600, size, size, 9)), nullptr);
    double area = 0.0;
    for (const Moments& cell : found.cells) area += cell.area;
    EXPECT_NEAR(area, 1.0, 1e-12);
  }
}

TEST(Torus, IsInvariantUnderTranslations) {
  const Image image = wavy(4, 4);
  for (const std::size_t count : {5u, 300u}) {
    const Points points = random_points(count, 1, 1, 21);
    Points moved;
    for (const Vec2& p : points) moved.push_back(p + Vec2(0.25, 0.5));  // a shift by whole pixels
    Image shifted = image;
    for (std::size_t k = 0; k < 16; ++k)
      shifted.values[(k / 4 + 2) % 4 * 4 + (k % 4 + 1) % 4] = image.values[k];
    const Torus plain, dense(image), dense_moved(shifted);
    expect_near(evaluate_energy(plain, plain.sites(moved), kLambda),
                evaluate_energy(plain, plain.sites(points), kLambda), 1e-11);
    expect_near(evaluate_energy(dense_moved, dense_moved.sites(moved), kLambda),
                evaluate_energy(dense, dense.sites(points), kLambda), 1e-11);
  }
}

/// Compare with central differences, with sites close to the border and outside the square.
void expect_gradient_is_slope(const Torus& torus, std::size_t count) {
  Points points = random_points(count, 1, 1, 5);
  points[0] = Vec2(-1e-9, 0.3);
  points[1].x() += 3.0;
  points[2] = Vec2(0.7, 1.0);
  const Energy energy = evaluate_energy(torus, torus.sites(points), kLambda);
  const double scale = largest(energy.gradient);
  const double step = 1e-5 * torus.spacing(count);
  for (std::size_t k = 0; k < std::min<std::size_t>(count, 12); ++k)
    for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1)}) {
      const auto total = [&](double t) {
        Points moved = points;
        moved[k] += t * direction;
        return evaluate_energy(torus, torus.sites(moved), kLambda).total;
      };
      EXPECT_NEAR((total(step) - total(-step)) / (2.0 * step),
                  energy.gradient[k].head<2>().dot(direction), 1e-6 * scale)
          << count << " sites, site " << k;
    }
}

TEST(FlatDomains, GiveTheSameUnderADensityOfAnyScale) {
  const auto scaled = [](double scale) {
    Image image = wavy(5, 6);
    for (double& value : image.values) value *= scale;
    return image;
  };
  const auto solve = [&](double scale, bool torus) {
    const Image image = scaled(scale);
    return torus ? sample(Torus(image), 150) : sample(Plane::image(1.0, 1.0, image), 150);
  };
  for (const bool torus : {false, true}) {
    const PlanarSamples expected = solve(1.0, torus);
    for (const double scale : {1e-200, 1e200}) {
      const PlanarSamples samples = solve(scale, torus);
      for (std::size_t k = 0; k < 150; ++k)
        ASSERT_LT((samples.positions[k] - expected.positions[k]).norm(), 1e-9) << scale << ' ' << k;
      EXPECT_NEAR(samples.report.energy, expected.report.energy, 1e-9);
    }
  }
}

TEST(Torus, HasTheGradientOfItsEnergy) {
  for (const std::size_t count : {3u, 4u, 12u, 80u}) {
    expect_gradient_is_slope(Torus(), count);
    expect_gradient_is_slope(Torus(wavy(5, 6)), count);
  }
}

TEST(Torus, SamplesExactlyThatManyInTheSquare) {
  const Torus domains[] = {Torus(), Torus(wavy(6, 4))};
  SampleOptions options;
  for (const Torus& torus : domains)
    for (const Start start : {Start::kPoisson, Start::kRandom})
      for (const std::size_t count : {0u, 1u, 2u, 3u, 5u, 200u}) {
        options.start = start;
        options.optimizer.max_evaluations = 15;
        const PlanarSamples samples = sample(torus, count, options);
        ASSERT_EQ(samples.positions.size(), count);
        for (const Vec2& p : samples.positions)
          EXPECT_TRUE(p.minCoeff() >= 0.0 && p.maxCoeff() < 1.0);
      }
}

TEST(Torus, GivesTheSameBytesForAnyThreadsAndAgain) {
  SampleOptions options;
  options.threads = 1;
  const PlanarSamples base = sample(Torus(), 400, options);
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    const PlanarSamples again = sample(Torus(), 400, options);
    EXPECT_EQ(again.positions, base.positions);
    EXPECT_EQ(again.report.energies, base.report.energies);
  }
}

TEST(Torus, ReportsTheEvennessOfItsSamples) {
  const PlanarSamples samples = sample(Torus(), 300);
  double least = 1.0;
  for (std::size_t i = 0; i < 300; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec2 d = samples.positions[i] - samples.positions[j];
      least = std::min(least, (d - d.array().round().matrix()).norm());
    }
  EXPECT_NEAR(samples.report.evenness.alpha_min, least / Torus().spacing(300), 1e-12);
}

TEST(Torus, StartsWithAllDartsApart) {
  const Torus torus;
  const Sites start = torus.start(Start::kPoisson, 500, 2, nullptr);
  const Evenness evenness = measure_evenness(torus.cells(start, nullptr));
  EXPECT_GT(evenness.alpha_min, 0.6);
  EXPECT_NE(torus.start(Start::kPoisson, 500, 3, nullptr).positions, start.positions);
}

/// Ranges around the values that both methods reach on the torus with 1,000 sites.
TEST(Torus, IsEven) {
  for (const bool paper : {false, true})
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      SampleOptions options = paper ? paper_options() : SampleOptions();
      options.seed = seed;
      const Report report = sample(Torus(), 1000, options).report;
      std::printf("%s: %d evaluations, e %.4f, alpha %.3f %.3f, spread %.4f, %.2f s\n",
                  paper ? "paper" : "default", report.evaluations, report.energy,
                  report.evenness.alpha_min, report.evenness.alpha_mean,
                  report.evenness.capacity_variation, report.seconds);
      EXPECT_TRUE(report.converged);
      EXPECT_LT(report.evenness.capacity_variation, 0.01);
      EXPECT_GT(report.evenness.alpha_min, paper ? 0.3 : 0.5);
      EXPECT_GT(report.energy, 0.16037);
      EXPECT_LT(report.energy, paper ? 0.179 : 0.1715);
    }
}

// ---- what is refused ----

TEST(Plane, NamesWhatIsWrong) {
  const auto refuses = [](const auto& action, std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>(action, parts);
  };
  refuses([] { (void)Plane::rectangle(0, 1); }, {"width", "0"});
  refuses([] { (void)Plane::rectangle(1, kNan); }, {"height", "nan"});
  refuses([] { (void)Plane::polygon({{0, 0}, {1, 0}}); }, {"outline", "2 points"});
  refuses([] { (void)Plane::polygon({}); }, {"outline", "0 points"});
  refuses([] { (void)Plane::polygon({{0, 0}, {1, kNan}, {1, 1}}); }, {"outline[1]", "nan"});
  refuses([] { (void)Plane::polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}}); },
          {"outline[2]", "crosses"});
  refuses([] { (void)Plane::polygon({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}); },
          {"outline[0]", "touches"});
  refuses([] { (void)Plane::polygon({{0, 0}, {1, 0}, {1, 1}, {0, 0}}); },
          {"outline[3]", "repeats"});
  refuses([] { (void)Plane::polygon({{0, 0}, {1, 0}, {2, 0}}); }, {"outline"});
  const std::vector<Points> outside = {kHoles[0], {{5, 5}, {6, 5}, {5, 6}}};
  refuses([&] { (void)Plane::polygon(kOutline, outside); }, {"holes[1]", "outline"});
  const std::vector<Points> across = {{{-1, 0.3}, {0.3, 0.3}, {0.3, 0.6}}};
  refuses([&] { (void)Plane::polygon(kOutline, across); }, {"holes[0]", "crosses"});
  const std::vector<Points> nested = {kHoles[1], {{2.3, 0.4}, {2.4, 0.4}, {2.4, 0.5}}};
  refuses([&] { (void)Plane::polygon(kOutline, nested); }, {"holes[1]", "holes[0]"});
}

TEST(Plane, NamesWhatIsWrongWithAnImage) {
  const auto refuses = [](const Image& image, std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>([&] { (void)Plane::image(1, 1, image); }, parts);
    expect_message<ArgumentError>([&] { (void)Torus(image); }, parts);
  };
  expect_message<ArgumentError>([] { (void)Plane::image(10, 10, {1, 1, {1.7e308}}); },
                                {"density", "not finite"});
  refuses({0, 3, {}}, {"density", "0 rows"});
  refuses({2, 2, {1, 1, 1}}, {"density", "3", "4"});
  refuses({2, 2, {1, 1, -1, 1}}, {"density[1, 0]", "-1"});
  refuses({2, 2, {1, kNan, 1, 1}}, {"density[0, 1]", "nan"});
  refuses({2, 2, {0, 0, 0, 0}}, {"density", "0 everywhere"});
}

TEST(Plane, NamesTheFirstSiteOutside) {
  const Plane domain = notched();
  const auto at = [&](const Vec2& p) { return domain.sites(Points{{0.1, 0.1}, p}); };
  expect_message<ArgumentError>([&] { (void)at({2.4, 0.5}); }, {"positions[1]", "outside"});
  expect_message<ArgumentError>([&] { (void)at({0.2, kNan}); }, {"positions[1]", "nan"});
  expect_message<ArgumentError>([&] { (void)Torus().sites(Points{{kNan, 0}}); },
                                {"positions[0]", "nan"});
}

TEST(SamplePlanar, StopsWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW((void)sample(Torus(), 100, {}, &context), Cancelled);
}

TEST(Plane, NamesASiteTooFarAway) {
  for (const double far : {1e12, 1e159, 1e308}) {
    const std::vector<Vec2> points = {{0.5, 0.5}, {far, -far}};
    expect_message<ArgumentError>([&] { (void)Plane::rectangle(1, 1).sites(points); },
                                  {"positions[1]", "outside the domain"});
  }
}

TEST(SamplePlanar, KeepsLockedSites) {
  const Plane square = Plane::rectangle(1.0, 1.0);
  const Torus torus;
  const std::vector<Vec2> places = {{0.2, 0.25}, {0.7, 0.3}, {0.4, 0.8}};
  for (const FlatDomain* domain :
       {static_cast<const FlatDomain*>(&square), static_cast<const FlatDomain*>(&torus)}) {
    const PlanarSamples samples = sample(*domain, 40, {.locked = domain->sites(places)});
    ASSERT_EQ(samples.positions.size(), 40u);
    for (std::size_t k = 0; k < places.size(); ++k)
      EXPECT_LE((samples.positions[k] - places[k]).norm(), 1e-12);
    EXPECT_GT(samples.report.evenness.alpha_min, 0.3);
  }
}

TEST(SamplePlanar, KeepsLockedSitesOfEachClass) {
  const Plane square = Plane::rectangle(1.0, 1.0);
  const std::vector<Vec2> places = {{0.2, 0.25}, {0.7, 0.3}};
  const std::vector<SampleClass> classes = {{.count = 10},
                                            {.count = 20, .locked = square.sites(places)}};
  const PlanarSamples samples = sample_classes(square, classes);
  for (std::size_t k = 0; k < places.size(); ++k)
    EXPECT_LE((samples.positions[10 + k] - places[k]).norm(), 1e-12);
}

}  // namespace
}  // namespace dapple::test
