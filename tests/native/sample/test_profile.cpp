// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/optimizer.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/stipple.hpp>
#include <dapple/tracker.hpp>
#include <dapple/window_tracker.hpp>

#include "base/stopwatch.hpp"
#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 300;

/// Check that the stages sum to the time and that each of `stages` took some.
void expect_stages(const Report& report, std::initializer_list<Stage> stages) {
  EXPECT_GT(report.seconds, 0.0);
  EXPECT_DOUBLE_EQ(report.profile.total(), report.seconds);
  for (std::size_t k = 0; k < kStageNames.size(); ++k)
    EXPECT_GE(report.profile.seconds[k], 0.0) << kStageNames[k];
  for (const Stage stage : stages)
    EXPECT_GT(report.profile[stage], 0.0) << kStageNames[static_cast<std::size_t>(stage)];
}

constexpr std::initializer_list<Stage> kAll = {
    Stage::kStart,      Stage::kNeighbors, Stage::kCells, Stage::kSolver,
    Stage::kProjection, Stage::kReporting, Stage::kOther};

TEST(Profile, OfSamplesHasEveryStage) {
  const Surface surface = blob(4).surface();
  expect_stages(sample(surface, kCount).report, kAll);
  Context context;
  expect_stages(sample(surface, kCount, {}, &context).report, kAll);
  EXPECT_EQ(context.progress(), 1.0);
  EXPECT_EQ(context.stopwatch(), nullptr) << "the caller's context stays the caller's";
}

TEST(Profile, OfClassesInOneStageOrTwoHasEveryStage) {
  const Surface surface = torus(40, 20).surface();
  const std::vector<SampleClass> classes = {{.count = 200}, {.count = 100}};
  expect_stages(sample_classes(surface, classes).report, kAll);
  expect_stages(sample_classes(surface, classes, paper_class_options()).report, kAll);
}

TEST(Profile, OfTooFewSamplesSumsUp) {
  for (const std::size_t count : {0, 1, 3})
    expect_stages(sample(blob(2).surface(), count).report, {Stage::kOther});
}

TEST(Profile, OfOtherCountsHasEveryStage) {
  const Surface surface = blob(4).surface();
  const Samples samples = sample(surface, kCount);
  expect_stages(resample(surface, samples, 2 * kCount).report, kAll);
  expect_stages(resample(surface, samples, kCount / 2).report, kAll);
}

TEST(Profile, OfRelaxedSamplesHasEveryStage) {
  const Shape shape = with_density(blob(4), [](const Vec3& p) { return p.z() > 0.5 ? 2.0 : 1.0; });
  const Surface before = blob(4).surface();
  const Surface after = before.with_density({shape.density_at, shape.density});
  const Samples samples = sample(before, kCount);
  expect_stages(relax(after, samples, changed_faces(before, after)).report, kAll);
}

TEST(Profile, OnFlatDomainsHasEveryStage) {
  expect_stages(sample(Plane::rectangle(2, 1), kCount).report, kAll);
  expect_stages(sample(Torus(), kCount).report, kAll);
}

TEST(Profile, OfStipplesHasEveryStage) {
  Image image{40, 60, {}};
  for (std::size_t k = 0; k < image.rows * image.columns; ++k)
    image.values.push_back(0.1 + static_cast<double>(k % 7));
  expect_stages(stipple_inks({&image, 1}, kCount).report, kAll);
}

TEST(Profile, OfTrackedFramesIsOfEachFrame) {
  const Shape shape = blob(4);
  Tracker tracker(shape.surface(), sample(shape.surface(), kCount));
  for (int frame = 1; frame <= 2; ++frame) {
    const Samples& samples = tracker.advance(deformed(shape.vertices, 0.1 * frame));
    expect_stages(samples.report, kAll);
  }
  for (int k = 0; k < 5; ++k) tracker.advance(deformed(shape.vertices, 0.2));
  expect_stages(tracker.samples().report, {Stage::kOther});
  EXPECT_EQ(tracker.samples().report.profile[Stage::kSolver], 0.0) << "a frame at rest";
}

TEST(Profile, OfAWindowCountsEveryPassOverAFrame) {
  const Shape shape = blob(3);
  const Samples samples = sample(shape.surface(), 100);
  const std::vector<std::vector<Vec3>> frames = {deformed(shape.vertices, 0.1),
                                                 deformed(shape.vertices, 0.2)};
  WindowOptions once;
  once.sweeps = 0;
  for (const WindowOptions& options : {once, WindowOptions()}) {
    const std::vector<Samples> found = track_window(shape.surface(), samples, frames, options);
    for (std::size_t t = 1; t < found.size(); ++t)
      expect_stages(found[t].report, {Stage::kNeighbors, Stage::kCells, Stage::kReporting});
  }
}

TEST(Profile, OfMeasurementsIsEmpty) {
  const Surface surface = blob(3).surface();
  const Report report = analyze(surface, sample(surface, 50));
  EXPECT_EQ(report.seconds, 0.0);
  EXPECT_EQ(report.profile.total(), 0.0);
}

TEST(Profile, ChangesNothing) {
  const Surface surface = blob(4).surface();
  const SurfaceDomain domain(surface);
  const Sites start = poisson_start(surface, kCount, 1);
  const OptimizerResult plain = optimize(domain, start, {});
  Stopwatch stopwatch;
  Context whole;
  Context context(whole, stopwatch);
  const OptimizerResult timed = optimize(domain, start, {}, &context);
  EXPECT_TRUE(same_bytes(timed.sites.positions, plain.sites.positions));
  EXPECT_EQ(timed.energies, plain.energies);
  EXPECT_EQ(timed.evaluations, plain.evaluations);
  EXPECT_GT(stopwatch.read()[Stage::kNeighbors], 0.0);
}

}  // namespace
}  // namespace dapple::test
