// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/relax.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <iostream>
#include <map>
#include <numeric>

#include "invariants.hpp"
#include "shapes.hpp"
#include "surface/ordered_surface.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Indices = std::vector<std::int32_t>;

/// A density at the vertices: `inside` within a ball, `outside` elsewhere.
std::vector<double> ball_density(const Surface& surface, const Vec3& middle, double radius,
                                 double inside, double outside = 1.0) {
  std::vector<double> density;
  for (const Vec3& x : surface.vertices())
    density.push_back((x - middle).norm() < radius ? inside : outside);
  return density;
}

Surface with_ball(const Surface& surface, const Vec3& middle, double radius, double inside) {
  return surface.with_density(
      {DensityAt::kVertices, ball_density(surface, middle, radius, inside)});
}

/// The indices of samples that stay, before and after.
std::vector<std::pair<std::size_t, std::size_t>> kept(const Samples& before, const Samples& after) {
  std::map<std::int32_t, std::size_t> place;
  for (std::size_t k = 0; k < after.size(); ++k) place[after.ids[k]] = k;
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t k = 0; k < before.size(); ++k)
    if (const auto found = place.find(before.ids[k]); found != place.end())
      result.emplace_back(k, found->second);
  return result;
}

bool same_place(const Samples& a, std::size_t i, const Samples& b, std::size_t j) {
  return a.positions[i] == b.positions[j] && a.normals[i] == b.normals[j] &&
         a.faces[i] == b.faces[j] && a.barycentric[i] == b.barycentric[j];
}

Indices moved(const Samples& before, const Samples& after) {
  Indices result;
  for (const auto& [i, j] : kept(before, after))
    if (!same_place(before, i, after, j)) result.push_back(static_cast<std::int32_t>(i));
  return result;
}

class RelaxOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, RelaxOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(RelaxOn, GivesSamplesOfTheSurface) {
  const Surface surface = GetParam().surface();
  const Samples before = sample(surface, 100);
  const Vec3 middle = before.positions[7];
  const double radius = 0.3 * std::sqrt(surface.area());
  const Surface after = with_ball(surface, middle, radius, 2.0);
  const Samples relaxed = relax(after, before, changed_faces(surface, after));
  check(after, relaxed);
  EXPECT_EQ(relaxed.report.count, relaxed.size());
  std::int32_t largest = *std::max_element(before.ids.begin(), before.ids.end());
  const std::size_t stay = kept(before, relaxed).size();
  for (std::size_t k = stay; k < relaxed.size(); ++k) EXPECT_EQ(relaxed.ids[k], ++largest);
}

TEST_P(RelaxOn, MovesNothingWhereNothingChanges) {
  const Surface surface = GetParam().surface();
  const Samples before = sample(surface, 50);
  EXPECT_TRUE(same_bytes(relax(surface, before, {}), before));
}

/// Beyond three spacings from a change, 99 % of the samples keep their bytes.
TEST(Relax, KeepsDistantSamples) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 2000);
  const Vec3 middle = before.positions[100];
  constexpr double kRadius = 0.25;
  for (const double density : {0.25, 0.9, 1.2, 3.0}) {
    const Surface after = with_ball(surface, middle, kRadius, density);
    const Samples relaxed = relax(after, before, changed_faces(surface, after));
    std::size_t far = 0, same = 0;
    for (const auto& [i, j] : kept(before, relaxed)) {
      if ((before.positions[i] - middle).norm() < kRadius + 3.5 * relaxed.report.spacing) continue;
      ++far;
      same += same_place(before, i, relaxed, j) ? 1 : 0;
    }
    EXPECT_GT(far, 1000u);
    EXPECT_GE(static_cast<double>(same), 0.99 * static_cast<double>(far)) << density;
  }
}

/// The count follows the integral of the density; the capacity per sample stays.
TEST(Relax, KeepsTheCapacityOfASample) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 2000);
  for (const double density : {0.0, 0.3, 1.0, 4.0}) {
    const Surface after = with_ball(surface, before.positions[0], 0.4, density);
    const Samples relaxed = relax(after, before, changed_faces(surface, after));
    const double wanted = 2000.0 * after.capacity() / surface.capacity();
    EXPECT_NEAR(static_cast<double>(relaxed.size()), wanted, 0.002 * wanted + 1.0) << density;
  }
}

/// Means over several seeds, of the whole surface and of the quarter with the largest change.
TEST(Relax, IsAsEvenAsAFullSolve) {
  const Surface surface = blob(4).surface();
  double variation[2] = {}, alpha[2] = {}, worst[2] = {};
  constexpr int kSeeds = 5;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const SampleOptions options{.seed = static_cast<std::uint64_t>(seed)};
    const Samples before = sample(surface, 1500, options);
    const Surface after = with_ball(surface, before.positions[10], 0.5, 2.0);
    const Samples relaxed = relax(after, before, changed_faces(surface, after));
    const Samples anew = sample(after, relaxed.size(), options);
    const Evenness of[2] = {analyze(after, relaxed).evenness, anew.report.evenness};
    for (int k = 0; k < 2; ++k) {
      variation[k] += of[k].capacity_variation / kSeeds;
      alpha[k] += of[k].alpha_mean / kSeeds;
      worst[k] += of[k].alpha_min / kSeeds;
    }
  }
  std::cout << "relaxed / anew: capacity variation " << variation[0] << " / " << variation[1]
            << ", alpha mean " << alpha[0] << " / " << alpha[1] << ", alpha min " << worst[0]
            << " / " << worst[1] << "\n";
  EXPECT_LT(variation[0], variation[1] + 0.002);
  EXPECT_GT(alpha[0], 0.98 * alpha[1]);
  EXPECT_GT(worst[0], 0.95 * worst[1]);
}

TEST(Relax, FillsAGapEvenly) {
  const Surface surface = blob(4).surface();
  double variation = 0.0, alpha = 0.0;
  constexpr int kSeeds = 4;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Samples before = sample(surface, 1500, {.seed = static_cast<std::uint64_t>(seed)});
    const Surface without = with_ball(surface, before.positions[10], 0.5, 0.0);
    const Indices changed = changed_faces(surface, without);
    const Samples left = relax(without, before, changed);
    EXPECT_LT(left.size(), 1450u);
    const Samples again = relax(surface, left, changed);
    EXPECT_NEAR(static_cast<double>(again.size()), 1500.0, 2.0);
    const Evenness evenness = analyze(surface, again).evenness;
    variation += evenness.capacity_variation / kSeeds;
    alpha += evenness.alpha_min / kSeeds;
  }
  EXPECT_LT(variation, 0.008);
  EXPECT_GT(alpha, 0.62);
}

/// Units are also tested in which sums of squared integrals of the density overflow or underflow.
TEST(Relax, IsTheSameInAnyUnitOfTheDensity) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 300);
  const auto refilled = [&](int power) {
    const double one = std::ldexp(1.0, power);
    const Surface full = surface.with_density(
        {DensityAt::kVertices, std::vector<double>(surface.vertex_count(), one)});
    const Surface without = full.with_density(
        {DensityAt::kVertices, ball_density(full, before.positions[10], 0.8, 0.0, one)});
    const Indices changed = changed_faces(full, without);
    return relax(full, relax(without, before, changed), changed);
  };
  const Samples expected = refilled(0);
  EXPECT_NEAR(static_cast<double>(expected.size()), 300.0, 2.0);
  for (const int power : {-1020, -1000, -100, 100, 1000, 1020}) {
    const Samples found = refilled(power);
    EXPECT_EQ(found.positions, expected.positions) << "2^" << power;
  }
}

/// A component may lose all its samples and get new ones.
TEST(Relax, EmptiesAndSettlesAComponent) {
  const Shape other =
      mapped(icosphere(3), [](const Vec3& x) -> Vec3 { return x + Vec3(5.0, 0.0, 0.0); });
  const Surface surface = joined(icosphere(3), other).surface();
  const Samples before = sample(surface, 600);
  const Vec3 middle(5.0, 0.0, 0.0);
  const Surface one = with_ball(surface, middle, 2.0, 0.0);
  const Indices changed = changed_faces(surface, one);
  const Samples left = relax(one, before, changed);
  EXPECT_NEAR(static_cast<double>(left.size()), 300.0, 1.0);
  for (const Vec3& x : left.positions) EXPECT_LT(x.x(), 2.0);
  const Samples again = relax(surface, left, changed);
  EXPECT_NEAR(static_cast<double>(again.size()), 600.0, 2.0);
  EXPECT_LT(analyze(surface, again).evenness.capacity_variation, 0.02);
}

TEST(Relax, FollowsMovedVertices) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  std::vector<Vec3> vertices = surface.vertices();
  const Vec3 middle = before.positions[3];
  for (Vec3& x : vertices) {
    const double distance = (x - middle).norm();
    if (distance < 0.4) x *= 1.0 + 0.5 * std::pow(1.0 - distance / 0.4, 2);
  }
  const Surface after = surface.deformed(vertices);
  const Samples relaxed = relax(after, before, changed_faces(surface, after));
  check(after, relaxed);
  EXPECT_EQ(relaxed.normals, after.normals(relaxed.faces, relaxed.barycentric));
  EXPECT_GT(relaxed.size(), before.size());
  EXPECT_LT(analyze(after, relaxed).evenness.capacity_variation, 0.01);
}

TEST(Relax, RefusesADensityThatDemandsTooManySamples) {
  const Surface before = grid(20).surface();
  const Samples samples = sample(before, 1000);
  for (const double far : {1e9, 1e12}) {
    std::vector<Vec3> vertices = before.vertices();
    vertices[0].z() = far;
    const Surface after = before.deformed(vertices);
    expect_message<ArgumentError>(
        [&] { (void)relax(after, samples, changed_faces(before, after)); },
        {"samples", "100000000"});
  }
}

TEST(Relax, GivesTheCount) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  const Indices faces = {before.faces[0], before.faces[1]};
  for (const std::size_t count : {990u, 1000u, 1001u, 1020u})
    EXPECT_EQ(relax(surface, before, faces, {.count = count}).size(), count);
}

/// Samples are removed in several rounds, and each of them rounds to whole numbers.
TEST(Relax, GivesTheCountWhereADensityChangesOnRandomMeshes) {
  constexpr int kMeshes = 300;
  Random random(1);
  int refused = 0;  // too few samples are free to be removed
  for (int k = 0; k < kMeshes; ++k) {
    const Shape shape = random_shape(random);
    const Surface surface = shape.surface();
    const Samples before = sample(surface, 10 + static_cast<std::size_t>(random.below(50)));
    const Surface after =
        surface.with_density({DensityAt::kVertices, random.densities(shape.vertices.size())});
    Indices half(surface.face_count() / 2);
    std::iota(half.begin(), half.end(), 0);
    const std::size_t count = before.size() - static_cast<std::size_t>(random.below(9));
    try {
      EXPECT_EQ(relax(after, before, half, {.count = count}).size(), count) << "mesh " << k;
    } catch (const ArgumentError&) {
      ++refused;
    }
  }
  EXPECT_LT(refused, kMeshes / 4);
}

/// If the count does not fit the region, the region grows until its border is even.
TEST(Relax, GrowsTheRegionIfTheCountDoesNotFit) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  const Samples relaxed = relax(surface, before, Indices{before.faces[0]}, {.count = 1005});
  EXPECT_LT(analyze(surface, relaxed).evenness.capacity_variation, 0.012);
  EXPECT_GT(moved(before, relaxed).size(), 60u);
}

TEST(Relax, LockedSamplesStay) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  const Surface after = with_ball(surface, before.positions[0], 0.5, 0.5);
  Indices locked;
  for (std::int32_t k = 0; k < 1000; k += 5) locked.push_back(k);
  const Samples relaxed = relax(after, before, changed_faces(surface, after), {.locked = locked});
  const Indices others = moved(before, relaxed);
  EXPECT_GT(others.size(), 20u);
  std::size_t there = 0;
  for (const auto& [i, j] : kept(before, relaxed))
    if (i % 5 == 0) {
      EXPECT_TRUE(same_place(before, i, relaxed, j));
      ++there;
    }
  EXPECT_EQ(there, locked.size());
}

/// The first `count` indices.
Indices first_ones(std::size_t count) {
  Indices result(count);
  std::iota(result.begin(), result.end(), 0);
  return result;
}

TEST(Relax, GivesTheCountWhereAllOrAllButOneAreLocked) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 80);
  const Indices everything = first_ones(surface.face_count());
  for (const std::size_t locked : {80u, 79u})
    for (const std::size_t count : {79u, 81u, 100u, 320u}) {
      if (count < locked) continue;
      const RelaxOptions options{.count = count, .locked = first_ones(locked)};
      const Samples relaxed = relax(surface, before, everything, options);
      ASSERT_EQ(relaxed.size(), count) << locked << " are locked";
      for (std::size_t k = 0; k < locked; ++k) EXPECT_TRUE(same_place(before, k, relaxed, k));
    }
}

/// New samples are distributed in proportion to the cells of locked samples; the one that may move
/// does not get all of them.
TEST(Relax, PutsSamplesBetweenLockedOnes) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 100);
  const Indices everything = first_ones(surface.face_count());
  for (const std::size_t locked : {100u, 99u}) {
    const RelaxOptions options{.count = 400, .locked = first_ones(locked)};
    const Report report = relax(surface, before, everything, options).report;
    EXPECT_GT(report.evenness.alpha_min, 0.4) << locked << " are locked";
    EXPECT_LT(report.evenness.capacity_variation, 0.2) << locked << " are locked";
  }
}

TEST(Relax, PutsSamplesBetweenLockedOnesWhereTheDensityRises) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 300);
  const Surface after = surface.with_density(
      {DensityAt::kVertices, ball_density(surface, before.positions[0], 0.8, 4.0)});
  const auto count = [&](const Indices& locked) {
    return relax(after, before, changed_faces(surface, after), {.locked = locked}).size();
  };
  const auto all = static_cast<double>(count(first_ones(300)));
  EXPECT_GT(all, 330.0);
  EXPECT_NEAR(all, static_cast<double>(count({})), 0.05 * all);
}

/// A cell without capacity has no gradient, so samples in the middle of a region that loses its
/// density used to stay there.
TEST(Relax, LeavesNoSampleWhereTheDensityIsZeroForAnUnchangedCount) {
  const Surface surface = icosphere(4).surface();
  const Samples before = sample(surface, 400);
  for (const double radius : {0.3, 0.8, 1.4}) {
    const Surface after = with_ball(surface, before.positions[3], radius, 0.0);
    const Indices changed = changed_faces(surface, after);
    for (const std::size_t count : {400U, 401U, 399U}) {
      const Samples relaxed = relax(after, before, changed, {.count = count});
      EXPECT_EQ(relaxed.size(), count);
      check_where_dense(after, relaxed);
      EXPECT_LT(relaxed.report.evenness.capacity_variation, 0.05) << radius << ", " << count;
    }
  }
}

TEST(Relax, LeavesNoSampleBesideLockedOnesWhereTheDensityIsZero) {
  const Surface surface = icosphere(4).surface();
  const Samples before = sample(surface, 200);
  const Surface after = with_ball(surface, before.positions[150], 0.8, 0.0);
  Indices everything(surface.face_count());
  std::iota(everything.begin(), everything.end(), 0);
  const Samples relaxed =
      relax(after, before, everything, {.count = 200, .locked = {0, 1, 2, 3, 4}});
  EXPECT_EQ(relaxed.size(), 200U);
  check_where_dense(after, relaxed, Indices{0, 1, 2, 3, 4});
}

Indices every_face(const Surface& surface) { return first_ones(surface.face_count()); }

/// The mean over several seeds is as even as new samples on this surface.
void expect_as_even_as_anew(const Surface& surface, const std::vector<Samples>& found) {
  double variation[2] = {}, alpha[2] = {};
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Evenness of[2] = {analyze(surface, found[k]).evenness,
                            sample(surface, found[k].size(), {.seed = k}).report.evenness};
    for (int which = 0; which < 2; ++which) {
      variation[which] += of[which].capacity_variation;
      alpha[which] += of[which].alpha_min;
    }
  }
  EXPECT_LT(variation[0], 1.5 * variation[1]);
  EXPECT_GT(alpha[0], alpha[1] / 1.5);
}

/// The start used to measure cells by the previous capacity per sample.
TEST(Relax, ReachesAnyCountFromAnyStart) {
  const Surface surface = blob(4).surface();
  std::vector<Samples> found;
  for (const auto& [before, after] : {std::pair<std::size_t, std::size_t>{20, 1000},
                                      {500, 1000},
                                      {1000, 20},
                                      {1, 200},
                                      {0, 100}}) {
    const Samples first = sample(surface, before);
    for (const Indices& changed : {every_face(surface), Indices{}, Indices{7}}) {
      const Samples relaxed = relax(surface, first, changed, {.count = after});
      ASSERT_EQ(relaxed.size(), after);
      EXPECT_LT(relaxed.report.evaluations, 60);
      found.push_back(relaxed);
    }
  }
  expect_as_even_as_anew(surface, found);
}

TEST(Relax, PutsManySamplesBetweenFewLockedOnes) {
  const Surface surface = blob(4).surface();
  const Samples first = sample(surface, 20);
  const Samples relaxed =
      relax(surface, first, every_face(surface), {.count = 1000, .locked = first_ones(20)});
  ASSERT_EQ(relaxed.size(), 1000u);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_TRUE(same_place(first, k, relaxed, k));
  expect_as_even_as_anew(surface, {relaxed});
}

/// Locked samples that all lie on one face.
Samples crowd(const Surface& surface, std::size_t count) {
  Random random(3);
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < count; ++k) {
    const double u = random.between(0.0, 1.0), v = random.between(0.0, 1.0 - u);
    weights.emplace_back(u, v, 1.0 - u - v);
  }
  return bind_samples(surface, std::vector<std::int32_t>(count, 11), weights);
}

TEST(Relax, SpreadsACrowdForAnUnchangedCount) {
  const Surface surface = blob(4).surface();
  std::vector<Samples> found;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    found.push_back(
        relax(surface, crowd(surface, 500), every_face(surface), {.seed = seed, .count = 500}));
    ASSERT_EQ(found.back().size(), 500u);
  }
  expect_as_even_as_anew(surface, found);
}

/// The other samples share the area that the crowd leaves.
TEST(Relax, IsEvenBesideACrowdOfLockedSamples) {
  const Surface surface = blob(4).surface();
  const Samples relaxed = relax(surface, crowd(surface, 100), every_face(surface),
                                {.count = 500, .locked = first_ones(100)});
  ASSERT_EQ(relaxed.size(), 500u);
  double sum = 0.0, squares = 0.0;
  const RestrictedVoronoi diagram =
      restricted_voronoi(surface, sites_of(relaxed), Cells::kEuclidean);
  for (std::size_t k = 100; k < 500; ++k) {
    sum += diagram.cells[k].capacity;
    squares += diagram.cells[k].capacity * diagram.cells[k].capacity;
  }
  EXPECT_LT(std::sqrt(400.0 * squares / (sum * sum) - 1.0), 0.08);
}

TEST(Relax, IsAsEvenAsAnewAcrossARoadWithoutDensity) {
  const Surface surface = grid(40).surface();
  const Samples before = sample(surface, 1000);
  std::vector<double> density;
  for (const Vec3& x : surface.vertices())
    density.push_back(std::abs(x.x() - 0.4 * x.y() - 0.2) < 0.06 ? 0.0 : 1.0);
  const Surface after = surface.with_density({DensityAt::kVertices, density});
  std::vector<Samples> found;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    found.push_back(
        relax(after, before, changed_faces(surface, after), {.seed = seed, .count = 1000}));
    ASSERT_EQ(found.back().size(), 1000u);
    check_where_dense(after, found.back());
  }
  expect_as_even_as_anew(after, found);
}

/// Samples outside the changed faces move as well.
TEST(Relax, MovesSamplesThatAreWhereTheDensityIsZero) {
  const Surface surface = icosphere(4).surface();
  const Samples before = sample(surface, 300);
  const Surface after = with_ball(surface, before.positions[3], 0.5, 0.0);
  for (const Indices& changed : {Indices{}, Indices{before.faces[200]}})
    check_where_dense(after, relax(after, before, changed));
  const Samples relaxed = relax(after, before, {}, {.locked = {3}});
  check_where_dense(after, relaxed, Indices{3});
  const auto place = std::find(relaxed.ids.begin(), relaxed.ids.end(), 3);
  ASSERT_NE(place, relaxed.ids.end());
  EXPECT_TRUE(
      same_place(before, 3, relaxed, static_cast<std::size_t>(place - relaxed.ids.begin())));
}

TEST(Relax, KeepsIdsAndClasses) {
  const Surface surface = blob(3).surface();
  Samples before = sample(surface, 200);
  before.fade.assign(200, 0.25);
  std::fill(before.classes.begin(), before.classes.end(), 3);
  for (std::int32_t& id : before.ids) id += 50;
  const Surface after = with_ball(surface, before.positions[0], 0.8, 4.0);
  const Samples relaxed = relax(after, before, changed_faces(surface, after));
  ASSERT_GT(relaxed.size(), 220u);
  EXPECT_EQ(relaxed.fade.front(), 0.25);
  EXPECT_EQ(relaxed.fade.back(), 1.0);
  EXPECT_EQ(relaxed.classes.back(), 3);
  EXPECT_EQ(relaxed.ids.front(), 50);
  EXPECT_GE(relaxed.ids.back(), 250);
}

TEST(Relax, GivesTheSameBytesForAnyNumberOfThreads) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 2000);
  const Surface after = with_ball(surface, before.positions[0], 0.5, 2.0);
  const Indices changed = changed_faces(surface, after);
  const Samples one = relax(after, before, changed, {.threads = 1});
  for (const int threads : {2, 3, 8})
    EXPECT_TRUE(same_bytes(relax(after, before, changed, {.threads = threads}), one));
}

TEST(Relax, NamesWhatIsWrong) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 20);
  const Indices faces = {before.faces[0]};
  const auto refuses = [&](const RelaxOptions& options, std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>([&] { (void)relax(surface, before, faces, options); }, parts);
  };
  refuses({.locked = {3, 20}}, {"locked[1] is 20", "0..19"});
  expect_message<ArgumentError>(
      [&] {
        (void)relax(surface, before, first_ones(surface.face_count()),
                    {.count = 9, .locked = first_ones(10)});
      },
      {"count is 9", "20 samples", "10 of which stay", "locked"});
  expect_message<ArgumentError>([&] { (void)relax(surface, before, Indices{1, -1}); },
                                {"changed[1] is -1"});
  Samples two = before;
  two.classes[5] = 1;
  expect_message<ArgumentError>([&] { (void)relax(surface, two, faces); },
                                {"samples.classes[5] is 1"});
  expect_message<ArgumentError>([&] { (void)changed_faces(surface, blob(3).surface()); },
                                {"other faces"});
}

TEST(ChangedFaces, AreThoseThatDiffer) {
  const Surface surface = icosphere(2).surface();
  EXPECT_TRUE(changed_faces(surface, surface).empty());
  std::vector<Vec3> vertices = surface.vertices();
  vertices[5] *= 1.1;
  Indices around;
  const std::vector<Face> faces = surface.faces();
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (std::find(faces[f].begin(), faces[f].end(), 5) != faces[f].end())
      around.push_back(static_cast<std::int32_t>(f));
  EXPECT_EQ(changed_faces(surface, surface.deformed(vertices)), around);
  std::vector<double> density(faces.size(), 1.0);
  density[7] = 2.0;
  const Surface dense = surface.with_density({DensityAt::kFaces, density});
  EXPECT_EQ(changed_faces(surface, dense), Indices{7});
}

}  // namespace
}  // namespace dapple::test
