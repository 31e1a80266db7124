// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <limits>

#include "invariants.hpp"
#include "shared_data.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

class SamplerOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, SamplerOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(SamplerOn, KeepsTheInvariants) {
  const Surface surface = GetParam().surface();
  for (const std::size_t count : {0u, 1u, 2u, 5u, 150u}) {
    const Samples samples = sample(surface, count);
    ASSERT_EQ(samples.size(), count);
    check(surface, samples);
    EXPECT_DOUBLE_EQ(samples.report.spacing, surface.spacing(count));
  }
}

TEST_P(SamplerOn, TakesMoreSamplesThanFaces) {
  const Surface surface = GetParam().surface();
  const std::size_t count = 2 * surface.face_count() + 10;
  SampleOptions options;
  options.optimizer.max_evaluations = 10;
  check(surface, sample(surface, count, options));
}

TEST_P(SamplerOn, GivesTheSameBytesForAnyNumberOfThreadsAndAgain) {
  const Surface surface = GetParam().surface();
  SampleOptions options;
  options.optimizer.max_evaluations = 15;
  options.threads = 1;
  const Samples base = sample(surface, 120, options);
  for (const int threads : {1, 2, 8, 0}) {
    options.threads = threads;
    EXPECT_TRUE(same_bytes(sample(surface, 120, options), base)) << threads << " threads";
  }
}

TEST(Sampler, GivesTheSameBytesForAnyNumberOfThreadsOnALargerMesh) {
  const Surface surface =
      with_density(blob(5), [](const Vec3& p) { return 1.2 + p.x(); }).surface();
  for (const Start start : {Start::kPoisson, Start::kRandom}) {
    SampleOptions options;
    options.start = start;
    options.optimizer.max_evaluations = 8;
    options.threads = 1;
    const Samples base = sample(surface, 3000, options);
    for (const int threads : {2, 8}) {
      options.threads = threads;
      EXPECT_TRUE(same_bytes(sample(surface, 3000, options), base)) << threads << " threads";
    }
  }
}

TEST(Sampler, DependsOnTheSeed) {
  const Surface surface = blob(2).surface();
  SampleOptions other;
  other.seed = 1;
  EXPECT_FALSE(same_bytes(sample(surface, 50), sample(surface, 50, other)));
}

/// Faces without density are distributed over the whole surface: samples are even outside of them,
/// and none is inside.
TEST(Sampler, KeepsOffFacesWithoutDensity) {
  Shape shape = with_face_density(blob(4), [](const Vec3&) { return 1.0; });
  for (std::size_t f = 0; f < shape.faces.size(); f += 7) shape.density[f] = 0.0;
  const Samples samples = sample(shape.surface(), 500, {.optimizer = {.tolerance = 1e-5}});
  for (const std::int32_t f : samples.faces)
    ASSERT_EQ(shape.density[static_cast<std::size_t>(f)], 1.0) << "face " << f;
  EXPECT_LE(samples.report.evenness.capacity_variation, 0.01);
}

// ---- evenness, as bands over several seeds ----

struct Band {
  double low, high;
  [[nodiscard]] bool holds(double value) const { return low <= value && value <= high; }
};

struct Bands {
  Band alpha_min, alpha_mean, capacity_variation, energy;
};

void expect_in_bands(const Surface& surface, SampleOptions options, const std::string& name,
                     const Bands& bands) {
  for (options.seed = 0; options.seed < 5; ++options.seed) {
    const Report report = sample(surface, 1000, options).report;
    std::cout << name << ", seed " << options.seed << ": alpha min " << report.evenness.alpha_min
              << ", mean " << report.evenness.alpha_mean << ", capacity variation "
              << report.evenness.capacity_variation << ", e " << report.energy << ", "
              << report.evaluations << " evaluations\n";
    EXPECT_TRUE(report.converged);
    EXPECT_TRUE(bands.alpha_min.holds(report.evenness.alpha_min)) << report.evenness.alpha_min;
    EXPECT_TRUE(bands.alpha_mean.holds(report.evenness.alpha_mean)) << report.evenness.alpha_mean;
    EXPECT_TRUE(bands.capacity_variation.holds(report.evenness.capacity_variation))
        << report.evenness.capacity_variation;
    EXPECT_TRUE(bands.energy.holds(report.energy)) << report.energy;
  }
}

// Hexagons would have alpha 1, variation 0 and energy 0.16037. For the paper's options, the method
// was measured on a torus at the paper's tolerance: alpha min 0.59, mean 0.83, variation 0.0033,
// energy 0.1707.
const Bands kPaper = {{0.30, 0.80}, {0.79, 0.90}, {0.0005, 0.010}, {0.1615, 0.1790}};

// For the trust region with repulsion, measured on meshes after about ten evaluations: alpha min
// 0.59 (across creases) to 0.70, mean 0.83 to 0.85, variation 0.005 to 0.008; more evaluations
// improve all of them.
const Bands kGap = {{0.50, 0.85}, {0.80, 0.92}, {0.0005, 0.008}, {0.1615, 0.1710}};

TEST(SamplerBands, WithThePapersOptionsOnATorus) {
  expect_in_bands(torus(120, 60).surface(), paper_options(), "torus, paper", kPaper);
}

TEST(SamplerBands, WithThePapersOptionsFromAPoissonStart) {
  SampleOptions options = paper_options();
  options.start = Start::kPoisson;
  expect_in_bands(torus(120, 60).surface(), options, "torus, paper from a Poisson start", kPaper);
}

TEST(SamplerBands, OnATorus) { expect_in_bands(torus(120, 60).surface(), {}, "torus", kGap); }

TEST(SamplerBands, FromARandomStart) {
  SampleOptions options;
  options.start = Start::kRandom;
  options.optimizer.tolerance = 1e-5;
  expect_in_bands(torus(120, 60).surface(), options, "torus, random start",
                  {{0.40, 0.85}, {0.79, 0.92}, {0.0005, 0.010}, {0.1615, 0.1760}});
}

TEST(SamplerBands, UnderADensity) {
  const Shape shape = with_density(torus(120, 60), [](const Vec3& p) { return 1.5 + p.x(); });
  expect_in_bands(shape.surface(), {}, "torus, density", kGap);
}

TEST(SamplerBands, OnABoxWithCreases) { expect_in_bands(box(10).surface(), {}, "box", kGap); }

TEST(SamplerBands, OnTheBunny) {
  DAPPLE_NEEDS_MESH("bunny");
  Bands bands = kGap;
  bands.capacity_variation.high = 0.01;  // of 40 seeds the largest is 0.009, the mean 0.0047
  expect_in_bands(shared_mesh("bunny").surface(), {}, "bunny", bands);
}

TEST(SamplerBands, OnTheFandisk) {
  DAPPLE_NEEDS_MESH("fandisk");
  expect_in_bands(shared_mesh("fandisk").surface(), {}, "fandisk",
                  {{0.40, 0.85}, {0.79, 0.92}, {0.0005, 0.015}, {0.1600, 0.1750}});
}

TEST(Sampler, TakesFewEvaluationsFromARandomStart) {
  const Surface surface = torus(60, 30).surface();
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SampleOptions options;
    options.seed = seed;
    options.start = Start::kRandom;
    EXPECT_LE(sample(surface, 1000, options).report.evaluations, 22) << seed;
  }
}

/// Repulsion ensures a minimum distance, which equal capacities alone do not.
TEST(Sampler, KeepsNeighborsApartWithTheGap) {
  const Surface surface = torus(60, 30).surface();
  double with = 0.0, without = 0.0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    SampleOptions options;
    options.seed = seed;
    with += sample(surface, 500, options).report.evenness.alpha_min / 3.0;
    options.optimizer.repulsion_weight = 0.0;
    without += sample(surface, 500, options).report.evenness.alpha_min / 3.0;
  }
  std::cout << "alpha min " << without << " without the repulsion, " << with << " with it\n";
  EXPECT_GT(with, without);
}

TEST(Sampler, TheCapacityTermMakesCapacitiesMoreEqual) {
  const Surface surface = torus(60, 30).surface();
  SampleOptions without;
  without.optimizer.capacity_weight = 0.0;
  const double plain = sample(surface, 500, without).report.evenness.capacity_variation;
  const double weighted = sample(surface, 500).report.evenness.capacity_variation;
  std::cout << "capacity variation " << plain << " without the term, " << weighted << " with it\n";
  EXPECT_LT(weighted, 0.25 * plain);
}

TEST(Sampler, FollowsTheDensity) {
  const Surface surface = with_density(grid(8), [](const Vec3& p) { return p.x(); }).surface();
  double left = 0;
  for (const Vec3& p : sample(surface, 900).positions) left += p.x() * p.x() < 1.0 / 3.0 ? 1 : 0;
  EXPECT_NEAR(left, 300.0, 20.0);
}

// ---- units ----

struct Frame {
  double scale, shift, tolerance;
};

class SamplerInUnits : public testing::TestWithParam<Frame> {};

INSTANTIATE_TEST_SUITE_P(Frames, SamplerInUnits,
                         testing::Values(Frame{1e-6, 0, 1e-3}, Frame{1e6, 0, 1e-3},
                                         Frame{1, 1e6, 2e-3}));

TEST_P(SamplerInUnits, IsAsEvenForEverySeed) {
  const auto [scale, shift, tolerance] = GetParam();
  const Shape shape = blob(3);
  const auto map = [scale = scale, shift = shift](const Vec3& p) {
    return Vec3(scale * p + Vec3(shift, shift, -shift));
  };
  const Surface surface = mapped(shape, map).surface();
  const Samples samples = sample(surface, 300);
  check(surface, samples);
  EXPECT_NEAR(samples.report.energy, sample(shape.surface(), 300).report.energy, tolerance);
}

/// Only ratios of densities count. If the scale is no power of two, values differ in their last
/// digits, and every step amplifies the difference.
TEST(Sampler, GivesTheSameUnderADensityOfAnyScale) {
  const auto scaled = [](double scale) {
    return with_density(blob(3),
                        [scale](const Vec3& p) { return scale * (1.2 + std::sin(2.0 * p.x())); })
        .surface();
  };
  const Samples expected = sample(scaled(1.0), 300);
  for (const double scale : {1e-300, 1e-200, 1e-100, 1e100, 1e200, 1e300}) {
    const Surface surface = scaled(scale);
    const Samples samples = sample(surface, 300);
    EXPECT_TRUE(samples.report.converged) << scale;
    EXPECT_NEAR(samples.report.energy, expected.report.energy, 1e-3) << scale;
    EXPECT_NEAR(samples.report.evenness.capacity_variation,
                expected.report.evenness.capacity_variation, 2e-3)
        << scale;
    EXPECT_NEAR(analyze(surface, expected).energy, expected.report.energy, 1e-12) << scale;
    EXPECT_NEAR(surface.capacity() / scale, scaled(1.0).capacity(), 1e-12 * scaled(1.0).capacity());
  }
  // A power of two changes no digit of the values and no sample.
  for (const double scale : {0x1p-1000, 0x1p-664, 0x1p-40, 0x1p664, 0x1p1000})
    EXPECT_TRUE(same_bytes(sample(scaled(scale), 300), expected)) << scale;
}

TEST(Sampler, GivesTheSameClassesUnderDensitiesOfAnyScale) {
  const Surface surface = blob(3).surface();
  const auto classes = [&](double first, double second) {
    std::vector<double> one, two;
    for (const Vec3& x : surface.vertices()) {
      one.push_back(first * (1.5 + std::sin(x.x())));
      two.push_back(second * (1.5 + std::sin(x.y())));
    }
    return std::vector<SampleClass>{
        {.count = 80, .surface = surface.with_density({DensityAt::kVertices, one})},
        {.count = 120, .surface = surface.with_density({DensityAt::kVertices, two})}};
  };
  const Samples expected = sample_classes(surface, classes(1.0, 1.0));
  EXPECT_TRUE(same_bytes(sample_classes(surface, classes(0x1p-664, 0x1p664)), expected));
}

TEST(Sampler, GivesCapacitiesInTheCallersUnit) {
  for (const double scale : {1e-200, 1e-30, 1e30, 1e200}) {
    const Shape shape =
        with_density(blob(2), [scale](const Vec3& p) { return scale * (1.5 + std::sin(p.x())); });
    const Surface surface = shape.surface();
    const Samples samples = sample(surface, 50);
    const RestrictedVoronoi diagram =
        restricted_voronoi(surface, sites_of(samples), Cells::kEuclidean);
    double sum = 0.0;
    for (const Moments& cell : diagram.cells) sum += cell.capacity;
    EXPECT_NEAR(sum / shape.capacity(), 1.0, 1e-10) << scale;
    EXPECT_NEAR(evaluate_energy(surface, sites_of(samples), 30.0, Cells::kEuclidean).normalized,
                samples.report.energy, 0.1);
  }
}

// ---- options, progress ----

TEST(Sampler, NamesTheOptionOutOfRange) {
  const Surface surface = grid(1).surface();
  SampleOptions options;
  options.optimizer.max_evaluations = 0;
  expect_message<ArgumentError>([&] { (void)sample(surface, 3, options); },
                                {"max_evaluations", "0"});
  options = {};
  options.optimizer.capacity_weight = std::numeric_limits<double>::quiet_NaN();
  expect_message<ArgumentError>([&] { (void)sample(surface, 3, options); },
                                {"capacity_weight", "nan"});
  options = {};
  options.optimizer.tolerance = -1.0;
  expect_message<ArgumentError>([&] { (void)sample(surface, 3, options); }, {"tolerance", "-1"});
  options = {};
  options.threads = -2;
  expect_message<ArgumentError>([&] { (void)sample(surface, 3, options); }, {"threads", "-2"});
}

TEST(Sampler, SaysWhenItDidNotConverge) {
  SampleOptions options;
  options.optimizer.max_evaluations = 3;
  options.optimizer.tolerance = 0.0;
  const Report report = sample(blob(2).surface(), 200, options).report;
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.evaluations, 3);
}

/// Squares of 3 x 3 cells that hang together by one cell: hardly any step moves a sample from one
/// to the next.
Surface squares_on_necks() {
  constexpr int kCells = 79;
  Shape shape = grid(kCells);
  std::vector<Face> kept;
  for (const Face& face : shape.faces) {
    Vec3 middle = Vec3::Zero();
    for (const std::int32_t v : face)
      middle += kCells / 3.0 * shape.vertices[static_cast<std::size_t>(v)];
    const int x = static_cast<int>(middle.x()) % 4, y = static_cast<int>(middle.y()) % 4;
    if ((x < 3 && y < 3) || (x == 3 && y == 1) || (x == 1 && y == 3)) kept.push_back(face);
  }
  shape.faces = kept;
  return shape.surface();
}

TEST(Sampler, EvensOutPartsThatAreHardlyConnected) {
  const Surface surface = squares_on_necks();
  for (const std::uint64_t seed : {0u, 1u, 2u}) {
    const Report report = sample(surface, 1000, {.seed = seed}).report;
    EXPECT_LT(report.evenness.capacity_variation, 0.016) << seed;
    EXPECT_TRUE(report.converged) << seed;
  }
}

TEST(Sampler, EndsWithFullProgress) {
  Context context;
  (void)sample(blob(2).surface(), 100, {}, &context);
  EXPECT_EQ(context.progress(), 1.0);
  Context empty;
  (void)sample(blob(2).surface(), 0, {}, &empty);
  EXPECT_EQ(empty.progress(), 1.0);
}

TEST(Sampler, RefusesToBeginWhenCancelled) {
  Context context;
  context.cancel();
  EXPECT_THROW((void)sample(blob(2).surface(), 100, {}, &context), Cancelled);
  EXPECT_THROW((void)sample(blob(2).surface(), 0, {}, &context), Cancelled);
}

TEST(Sampler, ReportsTheVariationCausedByIntegerCountsPerComponent) {
  const Report one = sample(box(3).surface(), 100).report;
  EXPECT_EQ(one.whole_count_variation, 0.0);
  const Report many = sample(many_components(40).surface(), 100).report;
  EXPECT_GT(many.whole_count_variation, 0.05);
  EXPECT_LE(many.whole_count_variation, many.evenness.capacity_variation + 1e-12);
}

/// A power of two changes no digit.
TEST(Sampler, ReportsThatVariationForADensityOfAnyScale) {
  const auto told = [](double scale) {
    const Shape shape = with_density(
        many_components(40), [scale](const Vec3& p) { return scale * (1.5 + std::sin(p.x())); });
    return sample(shape.surface(), 100).report.whole_count_variation;
  };
  const double expected = told(1.0);
  EXPECT_GT(expected, 0.05);
  for (const double scale : {0x1p-664, 0x1p664}) EXPECT_EQ(told(scale), expected) << scale;
}

/// A floor of square steps: where they meet, cells exchange pieces and the energy jumps.
TEST(Sampler, IsEvenOnSteps) {
  const Surface surface = mapped(grid(60), [](const Vec3& p) {
                            const int square =
                                static_cast<int>(6.0 * p.x()) + static_cast<int>(6.0 * p.y());
                            return Vec3(p.x(), p.y(), square % 2 == 1 ? 0.1 : 0.0);
                          }).surface();
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Report report = sample(surface, 1000, {.seed = seed}).report;
    EXPECT_LE(report.evenness.capacity_variation, 0.012) << "seed " << seed;
    EXPECT_TRUE(report.converged) << "seed " << seed;
  }
}

}  // namespace
}  // namespace dapple::test
