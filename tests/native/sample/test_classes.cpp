// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

std::vector<std::size_t> counts(const std::vector<std::int32_t>& classes, std::size_t number) {
  std::vector<std::size_t> result(number, 0);
  for (const std::int32_t c : classes) ++result[static_cast<std::size_t>(c)];
  return result;
}

std::vector<double> along_x(const Surface& surface, double at_least, double at_most) {
  double low = 1e300, high = -1e300;
  for (const Vec3& x : surface.vertices()) {
    low = std::min(low, x.x());
    high = std::max(high, x.x());
  }
  std::vector<double> result;
  for (const Vec3& x : surface.vertices())
    result.push_back(at_least + (at_most - at_least) * (x.x() - low) / (high - low));
  return result;
}

class ClassesOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ClassesOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ClassesOn, HaveTheirCountsAndLieOnTheSurface) {
  const Surface surface = GetParam().surface();
  const std::vector<SampleClass> classes = {
      {.count = 40}, {.count = 0}, {.count = 1}, {.count = 90}};
  const Samples samples = sample_classes(surface, classes);
  EXPECT_EQ(counts(samples.classes, 4), (std::vector<std::size_t>{40, 0, 1, 90}));
  EXPECT_TRUE(std::is_sorted(samples.classes.begin(), samples.classes.end()));
  check_on_surface(surface, {samples.positions, samples.faces, {}}, samples.barycentric);
  ASSERT_EQ(samples.report.classes.size(), 4u);
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_EQ(samples.report.classes[c].count, classes[c].count) << c;
  EXPECT_EQ(samples.report.count, 131u);
}

TEST(Classes, OfOneClassAreOrdinarySamples) {
  const Surface surface = blob(3).surface();
  const std::vector<SampleClass> one = {{.count = 200}};
  EXPECT_TRUE(same_bytes(sample_classes(surface, one, {.sample = {}}).positions,
                         sample(surface, 200).positions));
  const std::vector<SampleClass> padded = {{.count = 0}, {.count = 200}};
  const Samples samples = sample_classes(surface, padded, {.sample = {}});
  EXPECT_EQ(counts(samples.classes, 2), (std::vector<std::size_t>{0, 200}));
}

TEST(Classes, AreEvenByThemselvesAndTogether) {
  const Surface surface = blob(4).surface();
  const std::vector<SampleClass> classes = {{.count = 200}, {.count = 400}, {.count = 400}};
  const Report report = sample_classes(surface, classes).report;
  EXPECT_LT(report.evenness.capacity_variation, 0.02);
  EXPECT_GT(report.evenness.alpha_min, 0.45);
  for (const Quality& quality : report.classes) {
    EXPECT_LT(quality.evenness.capacity_variation, 0.04);
    EXPECT_GT(quality.evenness.alpha_min, 0.45);
  }
}

/// Large discs, smaller ones, and samples between them, such as trees, bushes and grass.
TEST(Classes, WithRareOnesAreEvenWithoutOverlapAfterFewEvaluations) {
  const Surface surface = grid(40).surface();
  const double spacing = surface.spacing(1'230);
  const std::vector<SampleClass> classes = {{.count = 1'000},
                                            {.count = 30, .radius = 1.1 * spacing},
                                            {.count = 200, .radius = 0.45 * spacing}};
  const Report report = sample_classes(surface, classes).report;
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.evaluations, 60);
  EXPECT_LE(report.worst_overlap, 1e-3);
  EXPECT_LT(report.classes[1].evenness.capacity_variation, 0.02);
  EXPECT_LT(report.classes[2].evenness.capacity_variation, 0.04);
  EXPECT_LT(report.classes[0].evenness.capacity_variation, 0.06);
  EXPECT_GT(report.evenness.alpha_min, 0.45);
}

TEST(Classes, WithRareOnesKeepLockedSamplesAndTheEvaluationLimit) {
  const Surface surface = grid(20).surface();
  const Samples there = sample(surface, 5);
  const Sites locked{there.positions, there.faces, there.barycentric};
  const std::vector<SampleClass> classes = {{.count = 300}, {.count = 12, .locked = locked}};
  ClassOptions options;
  options.sample.optimizer.max_evaluations = 7;
  const Samples samples = sample_classes(surface, classes, options);
  EXPECT_LE(samples.report.evaluations, 7);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(samples.positions[300 + k], there.positions[k]) << k;
}

/// The density of class 0 rises to the right, that of class 1 to the left.
TEST(Classes, FollowTheirOwnDensities) {
  const Surface surface = grid(12).surface();
  const std::vector<double> right = along_x(surface, 0.0, 1.0), left = along_x(surface, 1.0, 0.0);
  const std::vector<SampleClass> classes = {
      {.count = 400, .surface = surface.with_density({DensityAt::kVertices, right})},
      {.count = 400, .surface = surface.with_density({DensityAt::kVertices, left})}};
  const Samples samples = sample_classes(surface, classes);
  double low = 1e300, high = -1e300;
  for (const Vec3& x : surface.vertices()) {
    low = std::min(low, x.x());
    high = std::max(high, x.x());
  }
  std::vector<int> right_half(2, 0);
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (samples.positions[k].x() > 0.5 * (low + high))
      ++right_half[static_cast<std::size_t>(samples.classes[k])];
  EXPECT_NEAR(right_half[0], 300, 6);
  EXPECT_NEAR(right_half[1], 100, 6);
  EXPECT_LT(samples.report.evenness.capacity_variation, 0.03);
}

TEST(Classes, StayInTheirSupport) {
  const Surface surface = grid(12).surface();
  std::vector<double> left(surface.face_count()), right(surface.face_count());
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<Face> faces = surface.faces();
  double middle = 0.0;
  for (const Vec3& x : vertices) middle += x.x() / static_cast<double>(vertices.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double x = 0.0;
    for (const std::int32_t v : faces[f]) x += vertices[static_cast<std::size_t>(v)].x() / 3.0;
    left[f] = x < middle ? 1.0 : 0.0;
    right[f] = 1.0 - left[f];
  }
  const std::vector<SampleClass> classes = {
      {.count = 150, .surface = surface.with_density({DensityAt::kFaces, left})},
      {.count = 50, .surface = surface.with_density({DensityAt::kFaces, right})}};
  const Samples samples = sample_classes(surface, classes);
  for (std::size_t k = 0; k < samples.size(); ++k)
    EXPECT_GT((samples.classes[k] == 0 ? left : right)[static_cast<std::size_t>(samples.faces[k])],
              0.0)
        << "sample " << k;
}

TEST(Classes, DoNotDependOnTheThreads) {
  const Surface surface = box(4).surface();
  const std::vector<SampleClass> classes = {{.count = 150}, {.count = 350}};
  ClassOptions options;
  options.sample.threads = 1;
  const Samples one = sample_classes(surface, classes, options);
  options.sample.threads = 3;
  EXPECT_TRUE(same_bytes(one.positions, sample_classes(surface, classes, options).positions));
}

TEST(Classes, NeedNotBeEvenTogether) {
  ClassOptions options;
  options.union_weight = 0.0;
  const std::vector<SampleClass> classes = {{.count = 20}, {.count = 10}};
  const Surface surface = icosphere(2).surface();
  check(surface, sample_classes(surface, classes, options));
}

TEST(Classes, InTwoStagesMatchThePaper) {
  const Surface surface = blob(3).surface();
  const std::vector<SampleClass> classes = {{.count = 100}, {.count = 200}};
  const Report report = sample_classes(surface, classes, paper_class_options()).report;
  for (const Quality& quality : report.classes) EXPECT_LT(quality.energy, 0.25);
  EXPECT_LT(report.evenness.capacity_variation, 0.05);
}

/// Few large and many small objects.
TEST(Classes, WithRadiiDoNotOverlap) {
  const Surface surface = grid(4).surface();
  const double unit = std::sqrt(surface.area());
  const std::vector<SampleClass> classes = {{.count = 8, .radius = 0.08 * unit},
                                            {.count = 200, .radius = 0.015 * unit}};
  const Samples samples = sample_classes(surface, classes);
  double worst = 0.0;
  const auto radius = [&](std::size_t k) {
    return classes[static_cast<std::size_t>(samples.classes[k])].radius;
  };
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      worst = std::max(worst, 1.0 - (samples.positions[i] - samples.positions[j]).norm() /
                                        (radius(i) + radius(j)));
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(samples.report.worst_overlap, worst, 1e-9);
}

/// The largest depth by which other samples lie inside the discs of class 0; negative if none does.
double deepest_inside(const Samples& samples, double radius) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = 0; samples.classes[i] == 0 && j < samples.size(); ++j)
      if (samples.classes[j] != 0)
        nearest = std::min(nearest, (samples.positions[i] - samples.positions[j]).norm());
  return 1.0 - nearest / radius;
}

/// For example rocks among grass.
TEST(Classes, WithoutRadiusStayOutsideTheDiscsOfOthers) {
  const Surface surface = grid(12).surface();
  const double unit = std::sqrt(surface.area());
  for (const double radius : {0.03, 0.06}) {
    const std::vector<SampleClass> classes = {{.count = 25, .radius = radius * unit},
                                              {.count = 400}};
    const Samples samples = sample_classes(surface, classes);
    EXPECT_LT(deepest_inside(samples, classes[0].radius), 0.0) << radius;
    EXPECT_EQ(samples.report.worst_overlap, 0.0) << radius;
    EXPECT_LT(samples.report.classes[1].evenness.capacity_variation, 0.1) << radius;
  }
}

TEST(Classes, ReportLockedSamplesThatAreInsideTheDiscsOfOthers) {
  const Surface surface = grid(6).surface();
  const double unit = std::sqrt(surface.area());
  const Samples one = sample(surface, 1);
  const Sites locked{one.positions, one.faces, one.barycentric};
  const std::vector<SampleClass> classes = {{.count = 5, .radius = 0.05 * unit, .locked = locked},
                                            {.count = 60, .locked = locked}};
  const Report report = sample_classes(surface, classes).report;
  EXPECT_NEAR(report.worst_overlap, 1.0, 1e-6);
  EXPECT_EQ(std::max(report.overlapping[0], report.overlapping[1]), 5);
}

TEST(Classes, NameWhatCannotBe) {
  const Surface surface = grid(4).surface();
  const double unit = std::sqrt(surface.area());
  const std::vector<SampleClass> crowded = {{.count = 10}, {.count = 100, .radius = 0.1 * unit}};
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, crowded); },
                                {"class 1: 100 of radius"});
  const std::vector<SampleClass> negative = {{.count = 10, .radius = -1.0}};
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, negative); }, {"radius is -1"});
  const std::vector<SampleClass> second = {{.count = 10}, {.count = 10, .radius = -1.0}};
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, second); },
                                {"classes[1].radius is -1"});
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, {}); }, {"classes is empty"});
  const std::vector<SampleClass> foreign = {{.count = 10},
                                            {.count = 10, .surface = box(2).surface()}};
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, foreign); }, {"classes[1]"});
  const std::vector<SampleClass> pictured = {{.count = 3, .image = Image{1, 1, {1.0}}}};
  expect_message<ArgumentError>([&] { (void)sample_classes(surface, pictured); },
                                {"classes[0].image", "as a surface"});
  const std::vector<SampleClass> curved = {{.count = 3, .surface = surface}};
  expect_message<ArgumentError>([&] { (void)sample_classes(Plane::rectangle(1.0, 1.0), curved); },
                                {"classes[0].surface", "as an image"});
}

TEST(Classes, KeepLockedSitesWhereTheyAre) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 30, {.seed = 9});
  const Sites locked = {before.positions, before.faces, before.barycentric};
  SampleOptions options;
  options.locked = locked;
  const Samples samples = sample(surface, 300, options);
  ASSERT_EQ(samples.size(), 300u);
  for (std::size_t k = 0; k < 30; ++k)
    EXPECT_LT((samples.positions[k] - before.positions[k]).norm(), 1e-12) << k;
  EXPECT_LT(samples.report.evenness.capacity_variation, 0.05);
  options.locked.faces[3] = 1 << 30;
  expect_message<ArgumentError>([&] { (void)sample(surface, 300, options); }, {"faces[3]"});
  options.locked = locked;
  expect_message<ArgumentError>([&] { (void)sample(surface, 20, options); }, {"locked holds 30"});
}

/// The sphere's northern half has no density.
TEST(Classes, DoNotMoveLockedSitesOutsideTheDensity) {
  const Shape shape =
      with_face_density(icosphere(3), [](const Vec3& p) { return p.z() < 0.0 ? 1.0 : 0.0; });
  const Surface surface = shape.surface();
  const Samples all = sample(icosphere(3).surface(), 40, {.seed = 9});
  for (const Method method : {Method::kTrustRegion, Method::kLineSearch}) {
    SampleOptions options;
    options.optimizer.method = method;
    options.locked = {all.positions, all.faces, all.barycentric};
    const Samples samples = sample(surface, 300, options);
    for (std::size_t k = 0; k < all.size(); ++k) {
      EXPECT_TRUE(same_bytes({samples.positions[k]}, {all.positions[k]})) << k;
      EXPECT_TRUE(same_bytes({samples.barycentric[k]}, {all.barycentric[k]})) << k;
      EXPECT_EQ(samples.faces[k], all.faces[k]) << k;
    }
  }
}

TEST(Classes, DoNotMoveLockedSitesInEitherStage) {
  const Surface surface =
      with_face_density(blob(3), [](const Vec3& p) { return p.x() < 0.2 ? 1.0 : 0.0; }).surface();
  const Samples all = sample(blob(3).surface(), 30, {.seed = 9});
  const std::vector<SampleClass> classes = {
      {.count = 100},
      {.count = 150, .radius = 0.02, .locked = {all.positions, all.faces, all.barycentric}}};
  ClassOptions options;
  options.two_stages = true;
  const Samples samples = sample_classes(surface, classes, options);
  const std::vector<Vec3> held(samples.positions.begin() + 100, samples.positions.begin() + 130);
  EXPECT_TRUE(same_bytes(held, all.positions));
}

TEST(Classes, StayEvenOnADeformingSurface) {
  const Surface surface = blob(3).surface();
  const std::vector<SampleClass> classes = {{.count = 100}, {.count = 200}};
  const Samples samples = sample_classes(surface, classes);
  Tracker tracker(
      surface, samples,
      {.optimizer = {.repulsion_weight = 5.0, .max_evaluations = 30}, .classes = classes});
  for (int frame = 1; frame <= 5; ++frame) {
    std::vector<Vec3> vertices = surface.vertices();
    for (Vec3& x : vertices) x.z() *= 1.0 + 0.1 * frame;
    tracker.advance(vertices);
  }
  EXPECT_EQ(tracker.samples().classes, samples.classes);
  ASSERT_EQ(tracker.samples().report.classes.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    const double before = samples.report.classes[c].energy;
    EXPECT_LT(tracker.samples().report.classes[c].energy, before + 0.01) << c;
  }
}

TEST(PlanarClasses, AreEvenOnTheTorus) {
  const std::vector<SampleClass> classes = {{.count = 500}, {.count = 500}};
  ClassOptions options;
  options.sample.optimizer.max_evaluations = 25;
  const PlanarSamples samples = sample_classes(Torus(), classes, options);
  EXPECT_EQ(counts(samples.classes, 2), (std::vector<std::size_t>{500, 500}));
  EXPECT_GT(samples.report.evenness.alpha_min, 0.5);
  for (const Quality& quality : samples.report.classes) {
    EXPECT_GT(quality.evenness.alpha_min, 0.58);
    EXPECT_LT(quality.evenness.capacity_variation, 0.025);
  }
}

TEST(PlanarClasses, FollowTheirImages) {
  Image right{1, 8, {0, 1, 2, 3, 4, 5, 6, 7}}, left{1, 8, {7, 6, 5, 4, 3, 2, 1, 0}};
  const std::vector<SampleClass> classes = {{.count = 200, .image = right},
                                            {.count = 200, .image = left}};
  const PlanarSamples samples = sample_classes(Plane::rectangle(2.0, 1.0), classes);
  std::vector<double> mean(2, 0.0);
  for (std::size_t k = 0; k < samples.positions.size(); ++k)
    mean[static_cast<std::size_t>(samples.classes[k])] += samples.positions[k].x() / 200.0;
  EXPECT_GT(mean[0], 1.2);
  EXPECT_LT(mean[1], 0.8);
  std::vector<SampleClass> unlike = classes;
  unlike[1].image = Image{1, 2, {1, 1}};
  expect_message<ArgumentError>([&] { (void)sample_classes(Plane::rectangle(2.0, 1.0), unlike); },
                                {"density of class 1 is 1 x 2 pixels"});
}

}  // namespace
}  // namespace dapple::test
