// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/relax.hpp>
#include <dapple/sampler.hpp>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Indices = std::vector<std::int32_t>;

const Vec3 kMiddle(0.0, 0.0, 1.0);
constexpr double kBall = 0.3;

/// Few large discs, more smaller ones, and points.
std::vector<SampleClass> mixture() {
  return {{.count = 60, .radius = 0.1}, {.count = 300, .radius = 0.03}, {.count = 1000}};
}

Surface with_ball(const Surface& surface, double inside) {
  std::vector<double> density;
  for (const Vec3& x : surface.vertices())
    density.push_back((x - kMiddle).norm() < kBall ? inside : 1.0);
  return surface.with_density({DensityAt::kVertices, density});
}

RelaxOptions relaxing(std::vector<SampleClass> classes, bool free_counts = false) {
  return {.free_counts = free_counts,
          .optimizer = {.repulsion_weight = 5.0, .tolerance = 1e-4},
          .classes = std::move(classes)};
}

std::size_t count_of(const Samples& samples, std::int32_t c) {
  return static_cast<std::size_t>(std::count(samples.classes.begin(), samples.classes.end(), c));
}

/// The largest overlap of two discs, relative to the wanted distance, measured pair by pair.
double worst_overlap(const Samples& samples, std::span<const SampleClass> classes) {
  double worst = 0.0;
  const auto radius = [&](std::size_t k) {
    return classes[static_cast<std::size_t>(samples.classes[k])].radius;
  };
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (radius(i) > 0.0 && radius(j) > 0.0)
        worst = std::max(worst, 1.0 - (samples.positions[i] - samples.positions[j]).norm() /
                                          (radius(i) + radius(j)));
  return worst;
}

/// The number of samples of a class that have not moved.
std::size_t still(const Samples& before, const Samples& after, std::int32_t c) {
  std::size_t result = 0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const auto was = std::find(before.ids.begin(), before.ids.end(), after.ids[k]);
    if (after.classes[k] != c || was == before.ids.end()) continue;
    const auto row = static_cast<std::size_t>(was - before.ids.begin());
    if (before.positions[row] == after.positions[k]) ++result;
  }
  return result;
}

struct Relaxed {
  Surface before = blob(4).surface();
  Surface after = with_ball(before, 0.3);
  std::vector<SampleClass> classes = mixture();
  Samples samples = sample_classes(before, classes);
  Indices changed = changed_faces(before, after);
};

TEST(RelaxedClasses, HaveTheRequestedCounts) {
  const Relaxed r;
  const Samples found = relax(r.after, r.samples, r.changed, relaxing(r.classes));
  check(r.after, found);
  for (std::size_t c = 0; c < r.classes.size(); ++c)
    EXPECT_EQ(count_of(found, static_cast<std::int32_t>(c)), r.classes[c].count);
  EXPECT_LT(worst_overlap(found, r.classes), 2e-3);
  EXPECT_LT(analyze(r.after, found).evenness.capacity_variation, 0.12);
  EXPECT_EQ(found.report.classes.size(), 3u);
}

TEST(RelaxedClasses, AreReportedOneByOne) {
  const Surface surface = grid(20).surface();
  Indices changed;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f)
    if (surface.point(f, Vec3::Constant(1.0 / 3.0)).norm() < 0.4) changed.push_back(f);
  // Classes of like numbers are relaxed together in the end, others one after another.
  for (const std::size_t second : {400u, 60u}) {
    const std::vector<SampleClass> classes = {{.count = 600}, {.count = second}};
    const Samples samples = sample_classes(surface, classes);
    const Samples found = relax(surface, samples, changed, relaxing(classes));
    ASSERT_EQ(found.report.classes.size(), 2u);
    EXPECT_EQ(still(samples, found, 0) < 600u, second == 400u);  // among 60 others all is even
    for (std::size_t c = 0; c < 2; ++c) {
      const Quality& quality = found.report.classes[c];
      EXPECT_EQ(quality.count, classes[c].count);
      EXPECT_EQ(quality.spacing, surface.spacing(classes[c].count));
      if (still(samples, found, static_cast<std::int32_t>(c)) == classes[c].count) continue;
      EXPECT_GT(quality.evenness.alpha_min, 0.3) << second << ", class " << c;
      EXPECT_LT(quality.evenness.alpha_min, 0.9) << second << ", class " << c;
      EXPECT_LT(quality.evenness.capacity_variation, 0.2) << second << ", class " << c;
      EXPECT_GT(quality.bond_order, 0.3) << second << ", class " << c;
    }
  }
}

TEST(RelaxedClasses, StayWhereNothingHasChanged) {
  const Relaxed r;
  const Samples found = relax(r.after, r.samples, r.changed, relaxing(r.classes, true));
  check(r.after, found);
  EXPECT_LT(found.size(), r.samples.size());  // the density is lower
  EXPECT_GT(still(r.samples, found, 2), 500u);
  EXPECT_GT(still(r.samples, found, 1), 150u);
  EXPECT_LT(worst_overlap(found, r.classes), 2e-3);
  EXPECT_NEAR(found.report.worst_overlap, std::max(worst_overlap(found, r.classes), 0.0), 1e-9);
  EXPECT_EQ(found.report.count, found.size());
}

TEST(RelaxedClasses, AreAsEvenAsSolvedAnew) {
  const Relaxed r;
  const Samples anew = sample_classes(r.after, r.classes);
  const Samples found = relax(r.after, r.samples, r.changed, relaxing(r.classes, true));
  EXPECT_LT(analyze(r.after, found).evenness.capacity_variation,
            analyze(r.after, anew).evenness.capacity_variation + 0.02);
}

TEST(RelaxedClasses, OfOneNumberAreEvenTogether) {
  const Surface before = blob(4).surface(), after = with_ball(before, 2.0);
  const std::vector<SampleClass> classes(3, SampleClass{.count = 300});
  const Samples samples = sample_classes(before, classes);
  const Samples found =
      relax(after, samples, changed_faces(before, after), relaxing(classes, true));
  EXPECT_GT(found.size(), samples.size());
  EXPECT_LT(analyze(after, found).evenness.capacity_variation, 0.06);
  EXPECT_GT(analyze(after, found).evenness.alpha_min, 0.3);
}

TEST(RelaxedClasses, FollowTheirOwnDensity) {
  Relaxed r;
  std::vector<double> half;
  for (const Vec3& x : r.before.vertices()) half.push_back(x.x() > 0.0 ? 1.0 : 0.0);
  const Surface own = r.before.with_density({DensityAt::kVertices, half});
  r.classes[1].surface = own;
  const Indices changed = changed_faces(r.before, own);
  const Samples found = relax(r.before, r.samples, changed, relaxing(r.classes));
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found.classes[k] == 1) {
      EXPECT_GT(found.positions[k].x(), -0.2) << k;
    }
  }
  EXPECT_EQ(count_of(found, 1), r.classes[1].count);
}

TEST(RelaxedClasses, KeepLockedSamples) {
  const Relaxed r;
  RelaxOptions options = relaxing(r.classes);
  for (std::int32_t k = 0; k < 1360; k += 68) options.locked.push_back(k);
  const Samples found = relax(r.after, r.samples, r.changed, options);
  for (const std::int32_t k : options.locked) {
    const auto row = static_cast<std::size_t>(k);
    const auto at = std::find(found.ids.begin(), found.ids.end(), r.samples.ids[row]);
    ASSERT_NE(at, found.ids.end());
    EXPECT_EQ(found.positions[static_cast<std::size_t>(at - found.ids.begin())],
              r.samples.positions[row]);
  }
}

TEST(RelaxedClasses, GetTheirFirstSamples) {
  Relaxed r;
  r.classes.push_back({.count = 60, .radius = 0.02});
  const Samples found = relax(r.before, r.samples, {}, relaxing(r.classes));
  EXPECT_EQ(count_of(found, 3), 60u);
  EXPECT_EQ(found.size(), 1420u);
  EXPECT_LT(worst_overlap(found, r.classes), 2e-3);
}

TEST(RelaxedClasses, OfNothingChangedKeepEveryByte) {
  const Relaxed r;
  const Samples found = relax(r.before, r.samples, {}, relaxing(r.classes));
  EXPECT_EQ(found.positions, r.samples.positions);
  EXPECT_EQ(found.ids, r.samples.ids);
}

TEST(RelaxedClasses, AreTheSameForAnyNumberOfThreads) {
  const Relaxed r;
  RelaxOptions one = relaxing(r.classes), two = one;
  one.threads = 1;
  two.threads = 2;
  EXPECT_EQ(relax(r.after, r.samples, r.changed, one).positions,
            relax(r.after, r.samples, r.changed, two).positions);
}

TEST(RelaxedClasses, RefuseImpossibleRequests) {
  const Relaxed r;
  const auto refused = [&](const RelaxOptions& options, const std::string& words) {
    expect_message<ArgumentError>([&] { (void)relax(r.after, r.samples, r.changed, options); },
                                  {words});
  };
  refused(relaxing({{.count = 5}}), "samples.classes[60] is 1, outside 0..0");
  refused(relaxing({{.count = 5}, {.count = 5, .radius = -1.0}, {.count = 5}}),
          "classes[1].radius is -1");
  RelaxOptions both = relaxing(r.classes);
  both.count = 7;
  refused(both, "count is 7 and classes are given");
  std::vector<SampleClass> others = r.classes;
  others[2].surface = blob(2).surface();
  refused(relaxing(others), "classes[2] has a surface with other faces");
}

}  // namespace
}  // namespace dapple::test
