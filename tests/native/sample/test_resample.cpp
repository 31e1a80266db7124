// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <functional>
#include <iostream>
#include <limits>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

class ResampleOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ResampleOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ResampleOn, GivesTheCountWithUniqueIds) {
  const Surface surface = GetParam().surface();
  const Samples before = sample(surface, 100);
  for (const std::size_t count : {0u, 1u, 90u, 100u, 130u}) {
    const Samples after = resample(surface, before, count);
    ASSERT_EQ(after.size(), count);
    check_on_surface(surface, {after.positions, after.faces, {}}, after.barycentric);
    std::vector<std::int32_t> ids = after.ids;
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
  }
}

/// After small changes of count or density most samples stay in place.
TEST(Resample, MovesMostSamplesLittle) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  std::vector<double> tilted;
  for (const Vec3& x : surface.vertices()) tilted.push_back(1.0 + 0.01 * x.x());
  const Samples more = resample(surface, before, 1010), fewer = resample(surface, before, 990),
                other =
                    resample(surface.with_density({DensityAt::kVertices, tilted}), before, 1000);
  for (const Samples* after : {&more, &fewer, &other}) {
    const Report& report = after->report;
    std::cout << after->size() << " samples: slide median " << report.slide_median << ", mean "
              << report.slide_mean << ", max " << report.slide_max << ", capacity variation "
              << report.evenness.capacity_variation << ", " << report.evaluations
              << " evaluations\n";
    EXPECT_LT(report.slide_median, 0.15);
    EXPECT_LT(report.evenness.capacity_variation, 0.02);
    EXPECT_GT(report.evenness.alpha_min, 0.55);
  }
  for (std::size_t k = 0; k < 1000; ++k) EXPECT_EQ(more.ids[k], before.ids[k]);
  EXPECT_EQ(more.ids[1000], 1000);
}

// ---- where the density differs ----

/// Density 100 on a cap of a sixteenth of a sphere, 1 elsewhere.
double on_the_cap(const Vec3& p) { return p.z() > 0.875 ? 100.0 : 1.0; }

/// A density that rises smoothly from 1 to 100 along x.
double ramp(const Vec3& p) { return std::pow(10.0, 1.0 + std::clamp(p.x(), -1.0, 1.0)); }

double share(const Samples& samples, const std::function<bool(const Vec3&)>& part) {
  return static_cast<double>(
             std::count_if(samples.positions.begin(), samples.positions.end(), part)) /
         static_cast<double>(samples.size());
}

double dense_share(const Samples& samples) {
  return share(samples, [](const Vec3& p) { return p.z() > 0.875; });
}

/// Means over several runs, because a single run varies by chance.
struct MeanEvenness {
  double variation = 0.0, alpha = 0.0;

  void add(const Samples& samples, std::size_t runs) {
    variation += samples.report.evenness.capacity_variation / static_cast<double>(runs);
    alpha += samples.report.evenness.alpha_min / static_cast<double>(runs);
  }
};

/// The result is as even as new samples, or as those that were given: steps end there.
void expect_as_even(std::span<const Samples> runs, const Surface& surface, double given = 0.0) {
  constexpr std::size_t kRuns = 3;
  MeanEvenness fresh, after;
  SampleOptions options;
  for (options.seed = 0; options.seed < kRuns; ++options.seed)
    fresh.add(sample(surface, runs[0].size(), options), kRuns);
  for (const Samples& run : runs) {
    after.add(run, runs.size());
    EXPECT_TRUE(run.report.converged);
  }
  std::cout << runs[0].size() << " samples: capacity variation " << after.variation << ", fresh "
            << fresh.variation << ", alpha min " << after.alpha << ", fresh " << fresh.alpha << ", "
            << runs[0].report.evaluations << " evaluations\n";
  EXPECT_LE(after.variation, 1.5 * std::max(fresh.variation, given));
  EXPECT_GE(after.alpha, 0.9 * fresh.alpha);
}

void expect_as_even(const Samples& after, const Surface& surface, double given = 0.0) {
  expect_as_even({&after, 1}, surface, given);
}

/// The largest slide of the samples that stayed, in local spacings.
double worst_local_slide(const Surface& surface, const Samples& before, const Samples& after) {
  double worst = 0.0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const auto found = std::find(before.ids.begin(), before.ids.end(), after.ids[k]);
    if (found == before.ids.end()) continue;
    const double density = after.barycentric[k].dot(
        surface.ordered().densities(surface.ordered().ordered_face(after.faces[k])));
    const double local =
        surface.spacing(after.size()) * std::sqrt(surface.capacity() / surface.area() / density);
    const auto b = static_cast<std::size_t>(found - before.ids.begin());
    worst = std::max(worst, (after.positions[k] - before.positions[b]).norm() / local);
  }
  std::cout << "worst slide " << worst << " local spacings\n";
  return worst;
}

TEST(Resample, RemovesSamplesInProportionToTheDensity) {
  const Surface surface = with_face_density(icosphere(5), on_the_cap).surface();
  const Samples before = sample(surface, 1500);
  for (const std::size_t count : {1350u, 1650u, 750u, 3000u}) {
    const Samples after = resample(surface, before, count);
    EXPECT_NEAR(dense_share(after), dense_share(before), 0.01) << count;
    expect_as_even(after, surface, before.report.evenness.capacity_variation);
  }
}

TEST(Resample, SlidesNothingFarUnderARamp) {
  const Surface surface = with_density(icosphere(5), ramp).surface();
  const Samples before = sample(surface, 1500);
  for (const std::size_t count : {1350u, 1650u}) {
    const Samples after = resample(surface, before, count);
    expect_as_even(after, surface);
    EXPECT_LT(worst_local_slide(surface, before, after), 1.0) << count;
  }
}

/// The count stays, but many samples must move from regions that become sparser to denser ones.
TEST(Resample, FollowsAnotherDensity) {
  const Surface flat = icosphere(5).surface();
  const Surface steep = with_density(icosphere(5), ramp).surface();
  const auto right = [](const Vec3& p) { return p.x() > 0.5; };
  std::vector<Samples> there, back;
  SampleOptions options;
  for (options.seed = 0; options.seed < 4; ++options.seed) {
    const Samples on_flat = sample(flat, 1500, options), on_steep = sample(steep, 1500, options);
    there.push_back(resample(steep, on_flat, 1500));
    back.push_back(resample(flat, on_steep, 1500));
    EXPECT_NEAR(share(there.back(), right), share(on_steep, right), 0.01);
    EXPECT_NEAR(share(back.back(), right), share(on_flat, right), 0.01);
    EXPECT_LT(worst_local_slide(steep, on_flat, there.back()), 1.0);
    EXPECT_LT(worst_local_slide(flat, on_steep, back.back()), 1.0);
  }
  expect_as_even(there, steep);
  expect_as_even(back, flat);
}

/// Components do not exchange samples: each gets its count before samples move.
TEST(Resample, GivesEachComponentItsShare) {
  const Shape small = mapped(icosphere(3), [](const Vec3& p) { return Vec3(0.5 * p); });
  const Shape large = mapped(icosphere(4), [](const Vec3& p) { return Vec3(p + Vec3(4, 0, 0)); });
  const Surface surface = joined(small, large).surface();
  const Samples before = sample(surface, 1000);
  for (const std::size_t count : {500u, 900u, 1100u}) {
    const Samples after = resample(surface, before, count);
    const double on_small = share(after, [](const Vec3& p) { return p.x() < 2.0; });
    EXPECT_NEAR(on_small * static_cast<double>(count), 0.2 * static_cast<double>(count), 1.0);
    expect_as_even(after, surface);
  }
}

TEST(Resample, RemovesSamplesWhereTheDensityIsZero) {
  const Samples before = sample(icosphere(4).surface(), 600);
  const Surface half = with_face_density(icosphere(4), [](const Vec3& p) {
                         return p.z() < 0.0 ? 1.0 : 0.0;
                       }).surface();
  const Samples after = resample(half, before, 600);
  EXPECT_EQ(share(after, [](const Vec3& p) { return p.z() > 0.01; }), 0.0);
  expect_as_even(after, half);
}

TEST(Resample, MovesASampleRoundACreaseToWhereTheDensityIs) {
  const Shape fold{"Fold", {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}}};
  const Samples before =
      bind_samples(fold.surface(), std::vector<std::int32_t>{0}, std::vector{Vec3(0.2, 0.6, 0.2)});
  const Surface half = fold.surface().with_density({DensityAt::kFaces, std::vector{0.0, 1.0}});
  EXPECT_EQ(resample(half, before, 1).faces[0], 1);
  // the same without any step left
  EXPECT_EQ(resample(half, before, 1, {.optimizer = {.max_evaluations = 1}}).faces[0], 1);
}

TEST(Resample, ChangesNothingIfTheCountFits) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 300);
  EXPECT_TRUE(same_bytes(resample(surface, before, 300).positions, before.positions));
}

/// Locked samples.
std::vector<std::int32_t> rows_below(std::int32_t end) {
  std::vector<std::int32_t> rows(static_cast<std::size_t>(end));
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

TEST(Resample, KeepsLockedSamples) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 300);
  const std::vector<std::int32_t> locked = rows_below(30);
  for (const std::size_t count : {30U, 200U, 300U, 900U}) {
    const Samples after = resample(surface, before, count, {.locked = locked});
    ASSERT_EQ(after.size(), count);
    check(surface, after);
    for (std::size_t k = 0; k < 30; ++k) {
      EXPECT_EQ(after.ids[k], before.ids[k]);
      EXPECT_EQ(after.positions[k], before.positions[k]);
      EXPECT_EQ(after.barycentric[k], before.barycentric[k]);
    }
    const Sites stay{{before.positions.begin(), before.positions.begin() + 30},
                     {before.faces.begin(), before.faces.begin() + 30},
                     {before.barycentric.begin(), before.barycentric.begin() + 30}};
    const Samples anew = sample(surface, count, {.locked = stay});
    EXPECT_LE(after.report.evenness.capacity_variation,
              1.5 * anew.report.evenness.capacity_variation);
  }
}

TEST(Resample, IsAsEvenAsAnewForAnyCount) {
  const Surface surface = torus(48, 24).surface();
  for (const auto& [first, count] :
       {std::pair<std::size_t, std::size_t>{20, 1000}, {500, 1000}, {980, 1000}, {1000, 100}}) {
    const Samples after = resample(surface, sample(surface, first), count);
    const Evenness anew = sample(surface, count, {.seed = 1}).report.evenness;
    EXPECT_LT(after.report.evenness.capacity_variation,
              1.5 * std::max(anew.capacity_variation, 0.003));
    EXPECT_GT(after.report.evenness.alpha_min, anew.alpha_min / 1.5);
  }
}

TEST(Resample, NamesWhatIsWrongWithLockedRows) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 20);
  const auto refuses = [&](std::size_t count, const std::vector<std::int32_t>& locked,
                           std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>(
        [&] { (void)resample(surface, before, count, {.locked = locked}); }, parts);
  };
  refuses(9, {0, 20}, {"locked[1] is 20", "0..19"});
  refuses(9, rows_below(10), {"count is 9", "10 samples are locked"});
}

/// Samples constructed by a caller may lack positions: their faces and barycentric coordinates say
/// where they are.
TEST(Resample, PutsLockedSamplesWithoutAPositionWhereTheirFacesSay) {
  const Surface surface = blob(3).surface();
  const Samples whole = sample(surface, 20);
  for (const Eigen::Index axis : {0, 1, 2}) {
    Samples before = whole;
    before.positions[3][axis] = std::numeric_limits<double>::quiet_NaN();
    const Samples after = resample(surface, before, 25, {.locked = rows_below(10)});
    EXPECT_LE((after.positions[3] - whole.positions[3]).norm(), 1e-12) << "axis " << axis;
  }
}

TEST(Resample, NamesSamplesOfAnotherSurface) {
  const Samples before = sample(blob(3).surface(), 100);
  expect_message<ArgumentError>([&] { (void)resample(grid(2).surface(), before, 100); },
                                {"faces["});
}

TEST(Resample, NamesIdsThatLeaveNoFreeIds) {
  const Surface surface = blob(2).surface();
  const Samples some = sample(surface, 20);
  std::vector<std::int32_t> ids = some.ids;
  ids[7] = 2147483640;
  const Samples before = bind_samples(surface, some.faces, some.barycentric, ids);
  EXPECT_EQ(resample(surface, before, 27).ids.back(), 2147483647);
  expect_message<ArgumentError>([&] { (void)resample(surface, before, 28); },
                                {"ids", "2147483640", "8"});
}

/// Samples constructed by a caller may have no ids.
TEST(Resample, NumbersSamplesWithoutIds) {
  const Surface surface = blob(2).surface();
  Samples before = sample(surface, 20);
  before.ids.clear();
  const Samples after = resample(surface, before, 30);
  for (std::size_t k = 0; k < after.size(); ++k)
    EXPECT_EQ(after.ids[k], static_cast<std::int32_t>(k));
}

}  // namespace
}  // namespace dapple::test
