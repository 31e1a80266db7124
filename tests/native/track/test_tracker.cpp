// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <limits>
#include <numbers>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"
#include "tracked_body.hpp"

namespace dapple::test {
namespace {

class TrackerOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, TrackerOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(TrackerOn, ReturnsTheSameBytesForNoMotion) {
  Tracker tracker = tracker_of(GetParam(), 80);
  const Samples first = tracker.samples();
  for (int frame = 0; frame < 3; ++frame) {
    const Samples& next = tracker.advance(GetParam().vertices);
    EXPECT_TRUE(same_bytes(next.positions, first.positions));
    EXPECT_TRUE(same_bytes(next.barycentric, first.barycentric));
    EXPECT_EQ(next.faces, first.faces);
    EXPECT_EQ(next.report.slide_max, 0.0);
    EXPECT_EQ(next.report.evaluations, 0);
  }
}

/// This happens on the new faces of a bake: a sample without a cell has no gradient that moves it
/// away.
TEST(Tracker, LeadsSamplesAwayFromWhereTheDensityIsZero) {
  const Shape shape = icosphere(3);
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, 100);
  std::vector<double> density;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f)
    density.push_back(surface.point(f, Vec3::Constant(1.0 / 3.0)).z() < 0.3 ? 1.0 : 0.0);
  Tracker tracker(surface.with_density({DensityAt::kFaces, density}), samples);
  for (const std::int32_t face : tracker.advance(shape.vertices).faces)
    EXPECT_GT(density[static_cast<std::size_t>(face)], 0.0);
}

/// Advance to a frame and repeat it until the tracker has settled.
std::vector<Vec3> settle(Tracker& tracker, const Shape& shape) {
  const std::vector<Vec3> vertices = deformed(shape.vertices, 0.3);
  for (int frame = 0; frame < 30 && !(frame > 0 && tracker.settled()); ++frame)
    tracker.advance(vertices);
  EXPECT_TRUE(tracker.settled());
  return vertices;
}

TEST(Tracker, EvaluatesNothingWhereNothingMoved) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const std::vector<Vec3> vertices = settle(tracker, shape);
  const Samples before = tracker.samples();
  const OrderedSurface* surface = &tracker.surface().ordered();
  const Samples& after = tracker.advance(vertices);
  EXPECT_TRUE(same_bytes(after.positions, before.positions));
  EXPECT_TRUE(same_bytes(after.normals, before.normals));
  EXPECT_TRUE(same_bytes(after.barycentric, before.barycentric));
  EXPECT_EQ(&tracker.surface().ordered(), surface) << "the surface was copied";
  EXPECT_TRUE(tracker.settled());
  const Report& report = after.report;
  EXPECT_EQ(report.evaluations, 0);
  EXPECT_EQ(report.slide_max, 0.0);
  EXPECT_EQ(report.energies.size(), 1u);
  EXPECT_EQ(report.energy, before.report.energy);
  EXPECT_EQ(report.evenness.alpha_min, before.report.evenness.alpha_min);
  EXPECT_EQ(report.bond_order, before.report.bond_order);
}

TEST(Tracker, GoesOnWhereNothingMovedButSomethingIsLeftToDo) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape, kCount, {.optimizer = {.max_evaluations = 2}});
  const std::vector<Vec3> vertices = deformed(shape.vertices, 1.5);
  tracker.advance(vertices);
  ASSERT_FALSE(tracker.settled());
  EXPECT_GT(tracker.advance(vertices).report.evaluations, 0);
}

TEST(Tracker, MeasuresAStoredFrameOnce) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const std::vector<Vec3> vertices = settle(tracker, shape);
  const Report known = tracker.samples().report;
  const Samples stored =
      bind_samples(tracker.surface(), tracker.samples().faces, tracker.samples().barycentric);
  tracker.resume(vertices, stored, true);
  for (const int evaluations : {1, 0}) {
    const Report& report = tracker.advance(vertices).report;
    EXPECT_EQ(report.evaluations, evaluations);
    EXPECT_EQ(report.energy, known.energy);
  }
}

TEST_P(TrackerOn, KeepsTheInvariants) {
  Tracker tracker = tracker_of(GetParam(), 80);
  for (int frame = 1; frame <= 3; ++frame) {
    const Samples& samples = tracker.advance(deformed(GetParam().vertices, 0.2 * frame));
    check(tracker.surface(), samples);
  }
}

TEST(Tracker, KeepsBarycentricsUnderRigidMotion) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const Samples first = tracker.samples();
  for (int frame = 1; frame <= 5; ++frame) {
    const auto move = [frame](const Vec3& p) {
      return Vec3(rotated(p, 0.7 * frame) + Vec3(3.0 * frame, 0, -1));
    };
    const Samples& next = tracker.advance(mapped(shape, move).vertices);
    EXPECT_EQ(next.faces, first.faces);
    for (std::size_t k = 0; k < kCount; ++k) {
      ASSERT_LE((next.barycentric[k] - first.barycentric[k]).norm(), 1e-12);
      ASSERT_LE((next.positions[k] - move(first.positions[k])).norm(), 1e-12);
    }
  }
}

/// The line search has no restoration: it ends when samples are as even as on the first frame.
TEST(Tracker, ALineSearchEndsWhereSamplesAreAsEvenAsAtFirst) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape, kCount, {.optimizer = {.method = Method::kLineSearch}});
  const Samples first = tracker.samples();
  const auto turn = [](const Vec3& p) { return rotated(p, 0.7); };
  const Samples& turned = tracker.advance(mapped(shape, turn).vertices);
  EXPECT_EQ(turned.report.evaluations, 1);
  for (std::size_t k = 0; k < kCount; ++k)
    ASSERT_LE((turned.barycentric[k] - first.barycentric[k]).norm(), 1e-12);
  const double energy = tracker.samples().report.energy;
  const Report& bent = tracker.advance(deformed(tracker.surface().vertices(), 0.3)).report;
  EXPECT_GT(bent.evaluations, 1);
  const double as_even = 5e-4;
  EXPECT_GT(bent.energies.front(), energy + as_even) << "there was nothing to make even";
  EXPECT_LE(bent.energies.back(), energy + as_even);
  EXPECT_GT(bent.energies[bent.energies.size() - 2], energy + as_even) << "it went on for nothing";
}

TEST(Tracker, KeepsBarycentricsUnderScaleAndMirror) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const Samples first = tracker.samples();
  for (const Vec3& factors : {Vec3(7, 7, 7), Vec3(-1, 1, 1), Vec3(1e-4, 1e-4, 1e-4)}) {
    const Samples& next = tracker.advance(
        mapped(shape, [&](const Vec3& p) { return Vec3(factors.cwiseProduct(p)); }).vertices);
    EXPECT_EQ(next.faces, first.faces);
    for (std::size_t k = 0; k < kCount; ++k)
      ASSERT_LE((next.barycentric[k] - first.barycentric[k]).norm(), 1e-12);
  }
}

TEST(Tracker, KeepsIdsAndClasses) {
  const Shape shape = body();
  const Surface surface = shape.surface();
  Samples samples = sample(surface, kCount);
  for (std::size_t k = 0; k < kCount; ++k) {
    samples.ids[k] = static_cast<std::int32_t>(1000 - 2 * k);
    samples.classes[k] = static_cast<std::int32_t>(k % 3);
  }
  Tracker tracker(surface, samples);
  for (int frame = 1; frame <= 6; ++frame) {
    const Samples& next = tracker.advance(deformed(shape.vertices, 0.4 * frame));
    EXPECT_EQ(next.ids, samples.ids);
    EXPECT_EQ(next.classes, samples.classes);
  }
}

/// On every frame every sample moves less than half a spacing relative to the surface.
TEST(Tracker, KeepsEverySampleNearItsPlaceOnAGentleDeformation) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  for (int frame = 1; frame <= 20; ++frame) {
    const Samples before = tracker.samples();
    const std::vector<Vec3> vertices = deformed(shape.vertices, 0.1 * frame);
    const Samples& after = tracker.advance(vertices);
    const double spacing = tracker.surface().spacing(kCount);
    std::size_t kept = 0;
    double slide_max = 0.0, slide_sum = 0.0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const Vec3 carried = tracker.surface().point(before.faces[k], before.barycentric[k]);
      const double slide = (after.positions[k] - carried).norm() / spacing;
      kept += slide < 0.5 ? 1 : 0;
      slide_max = std::max(slide_max, slide);
      slide_sum += slide;
    }
    EXPECT_EQ(kept, kCount) << "frame " << frame;
    EXPECT_NEAR(after.report.slide_max, slide_max, 1e-12);
    EXPECT_NEAR(after.report.slide_mean, slide_sum / kCount, 1e-12);
    if (frame % 5 == 0)
      std::cout << "frame " << frame << ": slide mean " << slide_sum / kCount << ", max "
                << slide_max << ", e " << after.report.energy << ", " << after.report.evaluations
                << " evaluations\n";
  }
}

/// However large the motion of a frame, evenness is restored over the next frames instead of by a
/// jump.
TEST(Tracker, KeepsEverySampleNearItsPlaceOnViolentFrames) {
  for (const Shape& shape :
       {blob(4), body(), with_density(torus(40, 20), [](const Vec3& p) { return 1.5 + p.x(); }),
        two_sheets(8, 0.03)}) {
    Tracker tracker = tracker_of(shape);
    Random random(17);
    double worst = 0.0;
    for (int frame = 1; frame <= 8; ++frame) {
      std::vector<Vec3> wild = deformed(shape.vertices, 1.5 * frame);
      const Vec3 stretch = Vec3(1.6, 1.6, 1.6) + random.in_box();
      for (Vec3& p : wild) p = stretch.cwiseProduct(p + 0.03 * random.in_box());
      worst = std::max(worst, tracker.advance(wild).report.slide_max);
    }
    std::cout << shape.name << ": slide max " << worst << '\n';
    EXPECT_LT(worst, 0.5) << shape.name;
  }
}

// The motion needs no slide above the limit; after a large motion evenness may take more than one
// frame. How far the energy rises in between depends on the start.
TEST(Tracker, StaysAsEvenAsTheFirstFrame) {
  const Shape shape = body();
  const Surface surface = shape.surface();
  const auto energy_on = [](const Surface& moved, const Samples& samples) {
    return evaluate_energy(moved, sites_of(samples), 30.0, Cells::kEuclidean).normalized;
  };
  constexpr std::uint64_t kSeeds = 5;
  double worst = 0.0, worst_left = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SampleOptions options;
    options.seed = seed;
    Tracker tracker(surface, sample(surface, kCount, options));
    const double first = energy_on(surface, tracker.samples());
    double above = 0.0, left = 0.0;
    for (int frame = 1; frame <= 20; ++frame) {
      const Samples before = tracker.samples();
      const std::vector<Vec3> vertices = deformed(shape.vertices, 0.15 * frame);
      const Surface moved = tracker.surface().deformed(vertices);
      const Samples carried = bind_samples(moved, before.faces, before.barycentric);
      left = std::max(left, energy_on(moved, carried) - first);
      const Samples& samples = tracker.advance(vertices);
      above = std::max(above, samples.report.energy - first);
      EXPECT_GE(samples.report.energy, 0.16037) << "frame " << frame;
    }
    worst += above / kSeeds;
    worst_left += left / kSeeds;
  }
  EXPECT_LE(worst, 2e-3);
  EXPECT_GT(worst_left, 2e-2) << "the motion does not disturb the samples: the test shows nothing";
}

TEST(Tracker, DoesNotTryToMakeIslandsEvenThatGrowAndShrink) {
  const Shape shape = two_components();
  const Surface surface = shape.surface();
  Tracker tracker(surface, sample(surface, 200));
  std::vector<Vec3> vertices = shape.vertices;
  const std::size_t first = vertices.size() / 2;
  const Vec3 middle = std::accumulate(vertices.begin() + static_cast<std::ptrdiff_t>(first),
                                      vertices.end(), Vec3(0.0, 0.0, 0.0)) /
                      static_cast<double>(vertices.size() - first);
  for (int frame = 0; frame < 5; ++frame) {
    for (std::size_t v = first; v < vertices.size(); ++v)
      vertices[v] = middle + 1.03 * (vertices[v] - middle);
    const Report& report = tracker.advance(vertices).report;
    EXPECT_LE(report.evaluations, 3) << frame;
    EXPECT_LT(report.evenness.capacity_variation, 1.1 * report.whole_count_variation + 0.01);
  }
  EXPECT_GT(tracker.samples().report.whole_count_variation, 0.03);
}

TEST(Tracker, GivesTheSameBytesForAnyNumberOfThreads) {
  const Shape shape = body();
  std::vector<Samples> base;
  for (const int threads : {1, 2, 8}) {
    TrackerOptions options;
    options.threads = threads;
    Tracker tracker = tracker_of(shape, kCount, options);
    for (int frame = 1; frame <= 4; ++frame) {
      const Samples& samples = tracker.advance(deformed(shape.vertices, 0.4 * frame));
      if (threads == 1) base.push_back(samples);
      EXPECT_TRUE(same_bytes(samples, base[static_cast<std::size_t>(frame - 1)]))
          << threads << " threads";
    }
  }
}

TEST(Tracker, SurvivesCollapseAndBack) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  std::vector<Vec3> collapsed = shape.vertices;
  for (const std::int32_t v : shape.faces[10])
    collapsed[static_cast<std::size_t>(v)] =
        shape.vertices[static_cast<std::size_t>(shape.faces[10][0])];
  for (const auto& vertices : {collapsed, shape.vertices})
    check(tracker.surface(), tracker.advance(vertices));
}

TEST(Tracker, SurvivesATeleport) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  Random random(3);
  std::vector<Vec3> wild = shape.vertices;
  for (Vec3& p : wild) p += 0.3 * random.in_box();
  check(tracker.surface(), tracker.advance(wild));
  check(tracker.surface(), tracker.advance(shape.vertices));
}

TEST(Tracker, TracksNothingAndOne) {
  const Shape shape = body();
  for (const std::size_t count : {0u, 1u, 2u}) {
    Tracker tracker = tracker_of(shape, count);
    check(tracker.surface(), tracker.advance(deformed(shape.vertices, 0.3)));
    EXPECT_EQ(tracker.samples().size(), count);
  }
}

TEST(Tracker, BeginsFromStoredBindings) {
  const Shape shape = body();
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, kCount);
  Tracker one(surface, samples);
  Tracker two(surface, bind_samples(surface, samples.faces, samples.barycentric, samples.ids,
                                    samples.classes));
  const std::vector<Vec3> next = deformed(shape.vertices, 0.5);
  EXPECT_TRUE(same_bytes(one.advance(next), two.advance(next)));
}

// ---- parts ----

Vec3 swollen(const Vec3& p, double share) {
  return p * (1.0 + 0.5 * share * std::exp(-4.0 * (p - Vec3(1, 0, 0)).squaredNorm()));
}

TEST(Tracker, SplitsAFrameOfFarMotion) {
  const Shape shape = body();
  const std::vector<Vec3> far =
      mapped(shape, [](const Vec3& p) { return swollen(p, 0.6); }).vertices;
  Tracker whole = tracker_of(shape, kCount, {.longest_motion = 0.0});
  EXPECT_EQ(whole.advance(far).report.parts, 1);
  Tracker split = tracker_of(shape);
  const Samples& samples = split.advance(far);
  EXPECT_GE(samples.report.parts, 3);
  EXPECT_LE(samples.report.slide_max, 0.45 + 1e-9);  // for the whole frame
  check(split.surface(), samples);
}

TEST(Tracker, CountsTheEvaluationsOfAllParts) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape, kCount, {.longest_motion = 0.01});
  const auto swell = [](const Vec3& p) { return swollen(p, 0.6); };
  const Report& report = tracker.advance(mapped(shape, swell).vertices).report;
  EXPECT_GE(report.parts, 5);
  EXPECT_GE(report.evaluations, report.parts);
}

TEST(Tracker, DoesNotSplitMovingAsAWhole) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const auto move = [](const Vec3& p) { return Vec3(rotated(p, 1.9) + Vec3(30, 0, -10)); };
  EXPECT_EQ(tracker.advance(mapped(shape, move).vertices).report.parts, 1);
}

// ---- refusals ----

TEST(Tracker, RefusesBadFramesAndIsUnchanged) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  tracker.advance(deformed(shape.vertices, 0.3));
  const Samples before = tracker.samples();
  const std::vector<Vec3> vertices = tracker.surface().vertices();

  std::vector<Vec3> bad = shape.vertices;
  bad.pop_back();
  expect_message<SurfaceError>(
      [&] { tracker.advance(bad); },
      {"vertices", std::to_string(bad.size()), std::to_string(shape.vertices.size())});
  expect_untouched(tracker, before, vertices);

  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    bad = shape.vertices;
    bad[20].x() = value;
    expect_message<SurfaceError>([&] { tracker.advance(bad); }, {"vertices[20]"});
    expect_untouched(tracker, before, vertices);
  }

  bad.assign(shape.vertices.size(), Vec3(1, 2, 3));
  expect_message<SurfaceError>([&] { tracker.advance(bad); }, {"area"});
  expect_untouched(tracker, before, vertices);
}

/// A needle has no area, however long it is, but samples on it may be far from the others.
TEST(Tracker, RefusesAFrameThatTakesASampleTooFarForSquaresOfDistances) {
  Shape shape = blob(3);
  const auto last = static_cast<std::int32_t>(shape.vertices.size());
  const auto needle = static_cast<std::int32_t>(shape.faces.size());
  shape.vertices.push_back(shape.vertices[0]);
  shape.faces.push_back({0, 0, last});
  const Surface surface = shape.surface();
  Samples samples = sample(surface, 100);
  std::vector<std::int32_t> faces = samples.faces;
  std::vector<Vec3> weights = samples.barycentric;
  faces[17] = needle;
  weights[17] = {0.5, 0.0, 0.5};
  samples = bind_samples(surface, faces, weights);
  Tracker tracker(surface, samples);
  const Samples before = tracker.samples();
  std::vector<Vec3> far = shape.vertices;
  far.back().x() = 1e155;
  expect_message<SurfaceError>([&] { tracker.advance(far); }, {"vertices", "samples[17]"});
  expect_untouched(tracker, before, shape.vertices);
  far.back().x() = 1e12;
  EXPECT_TRUE(std::isfinite(tracker.advance(far).report.energy));
}

TEST(Tracker, RefusesSamplesOfAnotherSurface) {
  const Samples samples = sample(body().surface(), 50);
  expect_message<ArgumentError>([&] { Tracker(tetrahedron().surface(), samples); }, {"faces["});
}

TEST(Tracker, NamesTheOptionOutOfRange) {
  const Surface surface = body().surface();
  const Samples samples = sample(surface, 10);
  TrackerOptions options;
  options.optimizer.max_evaluations = 0;
  expect_message<ArgumentError>(
      [&] {
        Tracker tracker(surface, samples, options);
        tracker.advance(surface.vertices());
      },
      {"max_evaluations", "0"});
}

TEST(Tracker, RefusesANegativeNumberOfThreads) {
  const Surface surface = body().surface();
  expect_message<ArgumentError>([&] { Tracker(surface, sample(surface, 10), {.threads = -1}); },
                                {"threads", "-1"});
}

TEST(Tracker, IsUnchangedWhenCancelledBefore) {
  const Shape shape = body();
  Tracker tracker = tracker_of(shape);
  const Samples before = tracker.samples();
  Context context;
  context.cancel();
  EXPECT_THROW(tracker.advance(deformed(shape.vertices, 0.5), &context), Cancelled);
  expect_untouched(tracker, before, shape.vertices);
}

TEST(Tracker, SplitsAFrameIntoAsManyPartsForEverSmallerMotions) {
  const Shape shape = body();
  const std::vector<Vec3> far =
      mapped(shape, [](const Vec3& p) { return swollen(p, 0.6); }).vertices;
  for (const double longest : {1e-10, 1e-12, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    Tracker tracker = tracker_of(shape, kCount, {.longest_motion = longest});
    EXPECT_EQ(tracker.advance(far).report.parts, 16) << longest;
  }
}

}  // namespace
}  // namespace dapple::test
