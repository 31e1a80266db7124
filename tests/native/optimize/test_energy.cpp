// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <limits>
#include <numbers>

#include "optimize/energy.hpp"
#include "shapes.hpp"
#include "shared_data.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kLambda = 30.0;
constexpr double kHexagon =
    5.0 * std::numbers::sqrt3 / 54.0;  // 0.16037: second moment of a hexagon of area 1

// ---- the gradient against central differences ----

/// Two directions that span a face.
std::array<Vec3, 2> tangents(const Shape& shape, std::int32_t face) {
  const auto [a, b, c] = shape.faces[static_cast<std::size_t>(face)];
  const Vec3& p = shape.vertices[static_cast<std::size_t>(a)];
  const Vec3 u = (shape.vertices[static_cast<std::size_t>(b)] - p).normalized();
  const Vec3 v = shape.vertices[static_cast<std::size_t>(c)] - p;
  return {u, (v - v.dot(u) * u).normalized()};
}

double slope(const Surface& surface, Sites sites, std::size_t k, const Vec3& direction, double step,
             Cells cells) {
  const auto energy = [&] { return evaluate_energy(surface, sites, kLambda, cells).total; };
  const Vec3 middle = sites.positions[k];
  sites.positions[k] = middle + step * direction;
  const double after = energy();
  sites.positions[k] = middle - step * direction;
  return (after - energy()) / (2.0 * step);
}

double largest_component(const std::vector<Vec3>& gradient) {
  double result = 0.0;
  for (const Vec3& g : gradient) result = std::max(result, g.cwiseAbs().maxCoeff());
  return result;
}

double nearest_distance(const Sites& sites, std::size_t k) {
  double squared = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < sites.size(); ++j)
    if (j != k)
      squared = std::min(squared, (sites.positions[j] - sites.positions[k]).squaredNorm());
  return std::sqrt(squared);
}

/// Move `count` of the sites along their faces and compare the slopes of the energy with its
/// gradient, to 1e-6 of the largest component. The second derivative of the energy has kinks where
/// a corner of a cell crosses a mesh edge or two cells meet; near a kink the error of a central
/// difference is linear in the step. The step is therefore small against the spacing (1e-5) and the
/// distance to the nearest site (1e-4); rounding stays below 1e-7. Sites stay away from the edges
/// of their faces.
void expect_gradient_is_slope(const Shape& shape, std::size_t sites_count, std::size_t count,
                              std::uint64_t seed, Cells cells = Cells::kEuclidean) {
  Random random(seed);
  const Surface surface = shape.surface();
  const Sites sites = random_sites(shape, sites_count, random, true);
  const std::vector<Vec3> gradient = evaluate_energy(surface, sites, kLambda, cells).gradient;
  const double scale = largest_component(gradient);
  ASSERT_GT(scale, 0.0);
  for (std::size_t k = 0; k < std::min(count, sites_count); ++k) {
    const double step =
        std::min(1e-5 * surface.spacing(sites_count), 1e-4 * nearest_distance(sites, k));
    for (const Vec3& direction : tangents(shape, sites.faces[k]))
      EXPECT_NEAR(slope(surface, sites, k, direction, step, cells), gradient[k].dot(direction),
                  1e-6 * scale)
          << shape.name << ", site " << k << ", seed " << seed;
  }
}

double ramp(const Vec3& p) { return 1.5 + p.x() + 0.5 * std::sin(2.0 * p.y()); }

TEST(Gradient, IsTheSlopeOnAFlatSurface) { expect_gradient_is_slope(grid(8), 40, 40, 1); }
TEST(Gradient, IsTheSlopeOnACurvedSurface) { expect_gradient_is_slope(blob(3), 60, 60, 2); }
TEST(Gradient, IsTheSlopeOnACreasedSurface) { expect_gradient_is_slope(box(4), 60, 60, 3); }
TEST(Gradient, IsTheSlopeOnAVaryingDensity) {
  expect_gradient_is_slope(with_density(blob(3), ramp), 60, 60, 4);
}
TEST(Gradient, IsTheSlopeOnCreasesUnderADensity) {
  expect_gradient_is_slope(with_density(box(4), ramp), 60, 60, 5);
}
TEST(Gradient, IsTheSlopeOnAPlaneUnderADensity) {
  expect_gradient_is_slope(with_density(grid(8), ramp), 40, 40, 6);
}
TEST(Gradient, IsTheSlopeWhereTheDensityJumpsBetweenFaces) {
  expect_gradient_is_slope(with_face_density(blob(3), ramp), 60, 60, 14);
  expect_gradient_is_slope(with_corner_density(grid(8), ramp), 40, 40, 15);
}
TEST(Gradient, IsTheSlopeThroughThinWalls) {
  expect_gradient_is_slope(two_sheets(4, 0.05), 40, 40, 7);
}
TEST(Gradient, IsTheSlopeAtANonManifoldEdge) { expect_gradient_is_slope(fin(4), 40, 40, 8); }
TEST(Gradient, IsTheSlopeWithMoreSitesThanFaces) {
  expect_gradient_is_slope(icosphere(0), 100, 60, 9);
}
TEST(Gradient, IsTheSlopeOnManyComponents) {
  expect_gradient_is_slope(many_components(30), 40, 40, 10);
}

// The area of cells that follow the surface jumps where a face changes its owner; between jumps the
// gradient is exact.
TEST(Gradient, IsTheSlopeOfConnectedCellsOnTwoSheets) {
  expect_gradient_is_slope(two_sheets(4, 0.05), 40, 40, 11, Cells::kConnected);
}
TEST(Gradient, IsTheSlopeOfConnectedCellsAtANonManifoldEdge) {
  expect_gradient_is_slope(fin(4), 40, 40, 12, Cells::kConnected);
}
TEST(Gradient, IsTheSlopeOfConnectedCellsOnTheCrank) {
  DAPPLE_NEEDS_MESH("crank");
  expect_gradient_is_slope(shared_mesh("crank"), 500, 40, 13, Cells::kConnected);
}

TEST(Gradient, IsTheSlopeOnRandomMeshes) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(700 + seed);
    expect_gradient_is_slope(random_shape(random), 12, 12, seed);
    if (HasFailure()) return;
  }
}

TEST(Gradient, IsTheSlopeOnTheCrank) {
  DAPPLE_NEEDS_MESH("crank");
  expect_gradient_is_slope(shared_mesh("crank"), 500, 20, 11);
}

TEST(Gradient, IsTheSlopeOnTheTruck) {
  DAPPLE_NEEDS_MESH("truck");
  expect_gradient_is_slope(shared_mesh("truck"), 300, 40, 12);
}

// ---- closed forms ----

Surface unit_square() { return grid(1).surface(); }

/// Sites in the plane of the unit square of two faces, one below and one above its diagonal.
Sites on_square(const std::vector<Vec3>& points) {
  Sites sites{points};
  for (const Vec3& p : points) sites.faces.push_back(p.y() > p.x() ? 1 : 0);
  return sites;
}

TEST(Energy, OfOneSiteInASquare) {
  const Energy energy =
      evaluate_energy(unit_square(), on_square({{0.5, 0.5, 0}}), kLambda, Cells::kEuclidean);
  EXPECT_NEAR(energy.cvt, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(energy.capacity_term, 1.0, 1e-15);
  EXPECT_NEAR(energy.total, 30.0 + 1.0 / 6.0, 1e-13);
  EXPECT_NEAR(energy.normalized, 1.0 / 6.0, 1e-13);
  EXPECT_LE(energy.gradient[0].norm(), 1e-14);
}

TEST(Energy, OfTwoSitesInASquare) {
  const Energy energy = evaluate_energy(unit_square(), on_square({{0.25, 0.5, 0}, {0.75, 0.5, 0}}),
                                        kLambda, Cells::kEuclidean);
  EXPECT_NEAR(energy.cvt, 2.0 * 0.5 / 12.0 * (0.25 + 1.0), 1e-15);
  EXPECT_NEAR(energy.capacity_term, 0.5, 1e-15);
  EXPECT_LE(largest_component(energy.gradient), 1e-14);
}

TEST(Energy, OfFourSitesInASquare) {
  const Sites sites =
      on_square({{0.25, 0.25, 0}, {0.75, 0.25, 0}, {0.25, 0.75, 0}, {0.75, 0.75, 0}});
  const Energy energy = evaluate_energy(unit_square(), sites, kLambda, Cells::kEuclidean);
  EXPECT_NEAR(energy.cvt, 1.0 / 24.0, 1e-15);
  EXPECT_NEAR(energy.capacity_term, 0.25, 1e-15);
  EXPECT_NEAR(energy.normalized, 1.0 / 6.0, 1e-13);
  EXPECT_LE(largest_component(energy.gradient), 1e-14);
}

/// The wall between two sites moves at half their speed: |V_0| = (x_0 + x_1) / 2.
TEST(Energy, OfTwoSitesInASquareOffBalance) {
  const double a = 0.2, b = 0.6, wall = 0.5 * (a + b);
  const Energy energy = evaluate_energy(unit_square(), on_square({{a, 0.5, 0}, {b, 0.5, 0}}),
                                        kLambda, Cells::kEuclidean);
  EXPECT_NEAR(energy.capacity_term, wall * wall + (1 - wall) * (1 - wall), 1e-15);
  const double capacity_slope =
      wall - (1 - wall);  // d/da of the sum of squares: 2 (w - (1 - w)) / 2
  const double cvt_slope = 2.0 * wall * (a - 0.5 * wall);
  EXPECT_NEAR(energy.gradient[0].x(), cvt_slope + kLambda * capacity_slope, 1e-13);
  EXPECT_NEAR(energy.gradient[0].y(), 0.0, 1e-13);
}

TEST(Energy, OfOneSiteUnderARamp) {
  const Surface surface = with_density(grid(3), [](const Vec3& p) { return p.x(); }).surface();
  const Sites sites{{{0.5, 0.5, 0}}, {8}};
  const Energy energy = evaluate_energy(surface, sites, kLambda, Cells::kEuclidean);
  EXPECT_NEAR(energy.capacity_term, 0.25, 1e-15);
  EXPECT_NEAR(energy.diagram.cells[0].mass, 1.0 / 3.0, 1e-15);
  EXPECT_NEAR(energy.cvt, 1.0 / 5.0 - 1.0 / 4.0 + 1.0 / 12.0 + 1.0 / 36.0, 1e-15);
  EXPECT_NEAR(energy.gradient[0].x(), 2.0 / 3.0 * (0.5 - 0.75), 1e-14);
  EXPECT_NEAR(energy.gradient[0].y(), 0.0, 1e-14);
}

TEST(Energy, OfPerfectHexagons) {
  const int cells = 8;
  const double pitch = 0.1;
  const Shape sheet =
      mapped(grid(cells), [](const Vec3& p) { return Vec3(2.0 * p - Vec3(1, 1, 0)); });
  Sites sites;
  for (int row = -8; row <= 8; ++row)
    for (int column = -8; column <= 8; ++column) {
      const Vec3 p(pitch * (column + 0.5 * (row & 1)), pitch * row * std::numbers::sqrt3 / 2.0,
                   0.0);
      const Vec3 at = (p + Vec3(1, 1, 0)) * (0.5 * cells);
      const int quad = static_cast<int>(at.y()) * cells + static_cast<int>(at.x());
      sites.positions.push_back(p);
      sites.faces.push_back(2 * quad +
                            (at.y() - std::floor(at.y()) > at.x() - std::floor(at.x()) ? 1 : 0));
    }
  const Energy energy = evaluate_energy(sheet.surface(), sites, kLambda, Cells::kEuclidean);
  int inner = 0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (sites.positions[k].cwiseAbs().maxCoeff() > 0.5) continue;
    const Moments& cell = energy.diagram.cells[k];
    EXPECT_NEAR(cell.area, std::numbers::sqrt3 / 2.0 * pitch * pitch, 1e-14);
    EXPECT_NEAR(cell.second / (cell.area * cell.area), kHexagon, 1e-11);
    EXPECT_LE(energy.gradient[k].norm(), 1e-13);
    ++inner;
  }
  EXPECT_GT(inner, 80);
}

/// Twelve sites at the corners of an icosahedron have equal cells on its sphere and zero gradient.
TEST(Energy, OfTheCornersOfAnIcosahedron) {
  const Shape shape = icosphere(3);
  Sites sites{{shape.vertices.begin(), shape.vertices.begin() + 12}};
  for (std::int32_t v = 0; v < 12; ++v)
    for (std::size_t f = 0; f < shape.faces.size(); ++f)
      for (const std::int32_t corner : shape.faces[f])
        if (corner == v && sites.faces.size() == static_cast<std::size_t>(v))
          sites.faces.push_back(static_cast<std::int32_t>(f));
  const Energy energy = evaluate_energy(shape.surface(), sites, kLambda, Cells::kEuclidean);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_NEAR(energy.diagram.cells[k].area, shape.area() / 12.0, 1e-13);
    const Vec3 outward = sites.positions[k].normalized();
    EXPECT_LE((energy.gradient[k] - energy.gradient[k].dot(outward) * outward).norm(), 1e-12);
  }
}

// ---- independence of units ----

struct Frame {
  double scale, shift, tolerance;
};

class EnergyInUnits : public testing::TestWithParam<Frame> {};

INSTANTIATE_TEST_SUITE_P(Frames, EnergyInUnits,
                         testing::Values(Frame{1e-6, 0, 1e-12}, Frame{1e6, 0, 1e-12},
                                         Frame{1, 1e6, 1e-7}, Frame{1e-6, 1, 1e-7},
                                         Frame{1e6, 1e6, 1e-12}));

TEST_P(EnergyInUnits, NormalizesToTheSameValue) {
  const auto [scale, shift, tolerance] = GetParam();
  const Shape shape = with_density(blob(2), ramp);
  Random random(51);
  Sites sites = random_sites(shape, 50, random, true);
  const double base =
      evaluate_energy(shape.surface(), sites, kLambda, Cells::kEuclidean).normalized;
  const auto map = [scale = scale, shift = shift](const Vec3& p) {
    return Vec3(scale * p + Vec3(shift, shift, -shift));
  };
  for (Vec3& p : sites.positions) p = map(p);
  const Surface surface = mapped(shape, map).surface();
  EXPECT_NEAR(evaluate_energy(surface, sites, kLambda, Cells::kEuclidean).normalized, base,
              tolerance * std::abs(base));
}

TEST(Energy, NormalizesToTheSameValueForAScaledDensity) {
  const Shape shape = with_density(blob(2), ramp);
  Shape heavy = shape;
  for (double& value : heavy.density) value *= 1e4;
  Random random(52);
  const Sites sites = random_sites(shape, 50, random);
  EXPECT_NEAR(evaluate_energy(heavy.surface(), sites, kLambda, Cells::kEuclidean).normalized,
              evaluate_energy(shape.surface(), sites, kLambda, Cells::kEuclidean).normalized,
              1e-12);
}

/// The terms are integrals of the squared density, so a density of any unit is possible.
TEST(Energy, GrowsWithTheSquareOfTheDensity) {
  const Shape shape = with_density(blob(2), [](const Vec3& p) { return 2.0 + p.x(); });
  Random random(31);
  const Sites sites = random_sites(shape, 20, random);
  const Energy once = evaluate_energy(shape.surface(), sites, kLambda, Cells::kEuclidean);
  for (const double factor : {1e-30, 1e-3, 7.0, 1e30}) {
    const auto scaled = [factor](const Vec3& p) { return factor * (2.0 + p.x()); };
    const Energy found =
        evaluate_energy(with_density(shape, scaled).surface(), sites, kLambda, Cells::kEuclidean);
    const double square = factor * factor;
    EXPECT_NEAR(found.total / square, once.total, 1e-12 * once.total) << factor;
    EXPECT_NEAR(found.cvt / square, once.cvt, 1e-12 * once.cvt) << factor;
    EXPECT_NEAR(found.capacity_term / square, once.capacity_term, 1e-12 * once.capacity_term);
    for (std::size_t k = 0; k < sites.size(); ++k)
      EXPECT_LE((found.gradient[k] / square - once.gradient[k]).norm(), 1e-11 * once.total);
  }
}

TEST(Energy, IsTheSameWithDensityOneAsWithout) {
  const Shape shape = blob(2);
  const Shape dense = with_density(shape, [](const Vec3&) { return 1.0; });
  Random random(53);
  const Sites sites = random_sites(shape, 50, random);
  const Energy a = evaluate_energy(shape.surface(), sites, kLambda, Cells::kEuclidean);
  const Energy b = evaluate_energy(dense.surface(), sites, kLambda, Cells::kEuclidean);
  EXPECT_NEAR(a.total, b.total, 1e-13 * a.total);
  for (std::size_t k = 0; k < 50; ++k) EXPECT_LE((a.gradient[k] - b.gradient[k]).norm(), 1e-12);
}

// ---- edges of the input ----

TEST(Energy, OfNoSitesIsZero) {
  const Energy energy = evaluate_energy(unit_square(), {}, kLambda, Cells::kEuclidean);
  EXPECT_EQ(energy.total, 0.0);
  EXPECT_TRUE(energy.gradient.empty());
}

TEST(Energy, LeavesTheSecondOfCoincidentSitesAlone) {
  const Energy energy =
      evaluate_energy(unit_square(), on_square({{0.3, 0.4, 0}, {0.7, 0.4, 0}, {0.3, 0.4, 0}}),
                      kLambda, Cells::kEuclidean);
  EXPECT_EQ(energy.gradient[2], Vec3::Zero().eval());
  EXPECT_NE(energy.gradient[0], Vec3::Zero().eval());
  EXPECT_NEAR(energy.diagram.cells[0].area + energy.diagram.cells[1].area, 1.0, 1e-15);
}

TEST(Energy, NamesTheFirstPositionThatIsNotFinite) {
  Sites sites = on_square({{0.3, 0.4, 0}, {0.7, 0.4, 0}, {0.3, 0.6, 0}});
  sites.positions[1].z() = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>(
      [&] { (void)evaluate_energy(unit_square(), sites, kLambda, Cells::kEuclidean); },
      {"positions[1]", "nan"});
  sites.positions[1].z() = -std::numeric_limits<double>::infinity();
  expect_message<ArgumentError>(
      [&] { (void)evaluate_energy(unit_square(), sites, kLambda, Cells::kEuclidean); },
      {"positions[1]", "-inf"});
}

TEST(Energy, NamesTheFirstFaceOutOfRange) {
  for (const std::int32_t bad : {-1, 2, 2147483647}) {
    Sites sites = on_square({{0.3, 0.4, 0}, {0.7, 0.4, 0}, {0.3, 0.6, 0}});
    sites.faces[2] = bad;
    expect_message<ArgumentError>(
        [&] { (void)evaluate_energy(unit_square(), sites, kLambda, Cells::kEuclidean); },
        {"faces[2]", std::to_string(bad)});
  }
}

TEST(Energy, RefusesArraysOfDifferentLength) {
  Sites sites = on_square({{0.3, 0.4, 0}, {0.7, 0.4, 0}});
  sites.faces.pop_back();
  expect_message<ArgumentError>(
      [&] { (void)evaluate_energy(unit_square(), sites, kLambda, Cells::kEuclidean); },
      {"faces", "1", "2"});
}

TEST(Energy, RefusesABadWeight) {
  const Sites sites = on_square({{0.3, 0.4, 0}});
  for (const double bad :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    expect_message<ArgumentError>(
        [&] { (void)evaluate_energy(unit_square(), sites, bad, Cells::kEuclidean); },
        {"capacity_weight"});
}

TEST(Energy, StopsWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW((void)evaluate_energy(unit_square(), on_square({{0.3, 0.4, 0}}), kLambda,
                                     Cells::kEuclidean, &context),
               Cancelled);
}

/// Where coordinates have few digits left, the density must not be evaluated at rounded positions.
TEST(Energy, SharesOutADensityFarFromTheOrigin) {
  for (const double far : {0.0, 1e6, 1e9, 1e12}) {
    Random random(3);
    Shape shape = mapped(grid(3), [&](const Vec3& p) { return Vec3(p + far * Vec3(1, 0.7, 0.3)); });
    for (std::size_t k = 0; k < shape.vertices.size(); ++k)
      shape.density.push_back(0.1 + random.uniform());
    const Surface surface = shape.surface();
    const Energy energy =
        evaluate_energy(surface, random_sites(shape, 100, random), 30.0, Cells::kEuclidean);
    double capacity = 0.0;
    for (const Moments& cell : energy.diagram.cells) capacity += cell.capacity;
    EXPECT_NEAR(capacity / surface.capacity(), 1.0, 1e-12) << far;
  }
}

// ---- energies that are not finite ----

/// A square with a needle at its corner, which has an area of 5e-41 and reaches 1e160 away.
Surface far_needle() {
  const Vec3 tip(1e160, 1e160, 3.0);
  const Shape shape{"Far needle",
                    {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), {1, 1, 0}, {1e-200, 0, 0}, tip},
                    {{0, 1, 2}, {1, 3, 2}, {0, 4, 5}}};
  return shape.surface();
}

/// Sample 2 lies on the needle.
Samples with_one_far(const Surface& surface) {
  const std::vector<Vec3> weights = {{0.2, 0.3, 0.5}, {0.3, 0.3, 0.4}, {0.2, 0.2, 0.6}};
  return bind_samples(surface, std::vector<std::int32_t>{0, 1, 2}, weights);
}

TEST(FiniteEnergy, IsDemandedOfAllThatMeasure) {
  const Surface surface = far_needle();
  const Samples samples = with_one_far(surface);
  const Sites sites{samples.positions, samples.faces, samples.barycentric};
  const auto refused = [](const auto& action) {
    expect_message<SurfaceError>(action, {"samples[2]", "vertices", "finite"});
  };
  refused([&] { (void)evaluate_energy(surface, sites, 30.0, Cells::kEuclidean); });
  refused([&] { (void)analyze(surface, samples); });
  refused([&] { (void)Tracker(surface, samples); });
  SampleOptions options;
  options.locked = sites;
  expect_message<SurfaceError>([&] { (void)sample(surface, 5, options); }, {"samples[", "finite"});
}

TEST(FiniteEnergy, IsThatOfSamplesElsewhere) {
  const Surface surface = far_needle();
  const Samples samples = sample(surface, 20);
  EXPECT_TRUE(std::isfinite(samples.report.energy));
  EXPECT_TRUE(std::isfinite(resample(surface, samples, 30).report.energy));
  // the far site has almost no capacity, so it is removed
  const std::vector<std::int32_t> changed = {2};
  EXPECT_TRUE(std::isfinite(relax(surface, with_one_far(surface), changed).report.energy));
}

/// Messages name the index among all samples, not the index within the class.
TEST(FiniteEnergy, NamesASampleByItsIndexAmongAll) {
  std::vector<Moments> cells(3);
  cells[1].second = std::numeric_limits<double>::infinity();
  const std::vector<std::int32_t> members = {4, 7, 9};
  expect_message<SurfaceError>([&] { check_finite_energy(std::nan(""), cells, members); },
                               {"samples[7]"});
  EXPECT_NO_THROW(check_finite_energy(1.0, cells, members));
}

}  // namespace
}  // namespace dapple::test
