// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <limits>

#include "optimize/finite_energy.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

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
