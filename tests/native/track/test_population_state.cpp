// SPDX-License-Identifier: GPL-3.0-or-later
// A population resumed from a frame continues as if it had never stopped.
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <functional>
#include <numbers>

#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr int kFade = 4;
constexpr int kFrames = 9;

/// A population on its first frame, and the shapes of later frames.
struct Body {
  std::string name;
  std::function<Population()> begin;
  std::function<Shape(int)> frame;
};
void PrintTo(const Body& one, std::ostream* out) { *out << one.name; }

Shape growing(int frame) {
  const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * frame / kFrames);
  return mapped(blob(3),
                [share](const Vec3& p) { return Vec3((1.0 + 0.5 * share) * p.x(), p.y(), p.z()); });
}

Population one_class(const Surface& surface) {
  return {surface, sample(surface, 150), {.fade = kFade}};
}

/// One class with density only above, and one with density everywhere.
Population two_classes(const Surface& surface) {
  std::vector<double> above;
  for (const Vec3& p : surface.vertices()) above.push_back(p.z() > 0.0 ? 1.0 : 0.1);
  const std::vector<SampleClass> classes = {
      {.count = 60, .surface = surface.with_density({DensityAt::kVertices, above})}, {.count = 60}};
  return {
      surface, sample_classes(surface, classes), {.fade = kFade, .tracker = {.classes = classes}}};
}

/// The faces change in some frames only.
Shape tearing(int frame) {
  return mapped(torn_cloth(frame, 12), [frame](const Vec3& p) {
    return Vec3((1.0 + 0.03 * frame) * p.x(), p.y(), p.z());
  });
}

std::vector<Body> bodies() {
  const auto balls = [](int frame) { return metaballs(3 * frame, 14); };
  return {{"Growing", [] { return one_class(growing(0).surface()); }, growing},
          {"Classes", [] { return two_classes(growing(0).surface()); }, growing},
          {"Balls", [balls] { return one_class(balls(0).surface()); }, balls},
          {"Cloth", [] { return one_class(tearing(0).surface()); }, tearing}};
}

bool same_places(const Samples& a, const Samples& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) &&
         same_bytes(a.barycentric, b.barycentric) && a.faces == b.faces && a.ids == b.ids &&
         a.classes == b.classes && a.fade == b.fade;
}

class StateOf : public testing::TestWithParam<Body> {};

INSTANTIATE_TEST_SUITE_P(Bodies, StateOf, testing::ValuesIn(bodies()),
                         [](const auto& one) { return one.param.name; });

TEST_P(StateOf, GoesOnWithTheSameBytes) {
  Population whole = GetParam().begin();
  bool changed = false;
  for (int frame = 1; frame < kFrames; ++frame) {
    Population resumed = GetParam().begin();
    resumed.resume(whole.surface(), whole.samples(), whole.state());
    EXPECT_TRUE(same_places(resumed.samples(), whole.samples())) << "before frame " << frame;
    const Surface next = GetParam().frame(frame).surface();
    whole.advance(next);
    resumed.advance(next);
    EXPECT_TRUE(same_bytes(resumed.samples(), whole.samples())) << "frame " << frame;
    EXPECT_EQ(resumed.samples().fade, whole.samples().fade) << "frame " << frame;
    EXPECT_EQ(resumed.samples().report.births, whole.samples().report.births);
    EXPECT_EQ(resumed.samples().report.deaths, whole.samples().report.deaths);
    changed = changed || whole.samples().report.births + whole.samples().report.deaths > 0;
  }
  EXPECT_TRUE(changed) << "nobody came or went";
}

TEST(PopulationState, ContainsTheWholeState) {
  const Body body = bodies().front();
  Population whole = body.begin(), resumed = body.begin();
  for (int frame = 1; frame < kFrames; ++frame) whole.advance(body.frame(frame).surface());
  resumed.resume(whole.surface(), whole.samples(), whole.state());
  const PopulationState a = whole.state(), b = resumed.state();
  EXPECT_EQ(a.fades, b.fades);
  EXPECT_EQ(a.first_faces, b.first_faces);
  EXPECT_TRUE(same_bytes(a.first_barycentric, b.first_barycentric));
  EXPECT_EQ(a.starts, b.starts);
  EXPECT_EQ(a.neighbors, b.neighbors);
  EXPECT_EQ(a.densities, b.densities);
  EXPECT_EQ(a.next_id, b.next_id);
  EXPECT_EQ(a.settled, b.settled);
}

/// If a state demands more samples, they are added in the next frame even if nothing moves.
TEST(PopulationState, MayDemandMoreSamples) {
  for (const std::size_t which : {0u, 1u}) {  // with one class and with two
    const Body body = bodies()[which];
    Population population = body.begin();
    const std::size_t before = population.samples().size();
    PopulationState state = population.state();
    state.densities.back() *= 1.5;
    population.resume(population.surface(), population.samples(), state);
    const Samples& after = population.advance(population.surface());
    const double asked = 0.5 * static_cast<double>(before) / static_cast<double>(which + 1);
    EXPECT_EQ(after.size(), before + static_cast<std::size_t>(asked)) << body.name;
  }
}

TEST(PopulationState, MayHaveNoSampleOfAClass) {
  const Surface surface = growing(0).surface();
  const auto begin = [&] {
    return Population(surface, sample(surface, 40), {.tracker = {.classes = {{}, {}}}});
  };
  Population whole = begin(), resumed = begin();
  whole.advance(growing(1).surface());
  EXPECT_EQ(whole.state().densities[1], 0.0);
  resumed.resume(whole.surface(), whole.samples(), whole.state());
  EXPECT_TRUE(same_places(resumed.samples(), whole.samples()));
}

TEST(PopulationState, IsRefusedIfItDoesNotFit) {
  const Surface surface = growing(0).surface();
  Population population = one_class(surface);
  const Samples before = population.samples();
  const PopulationState good = population.state();
  const auto expect_refused = [&](const std::function<void(PopulationState&)>& damage,
                                  std::initializer_list<std::string> parts) {
    PopulationState bad = good;
    damage(bad);
    expect_message<ArgumentError>([&] { population.resume(surface, before, bad); }, parts);
    EXPECT_TRUE(same_places(population.samples(), before));
  };
  expect_refused([](auto& s) { s.fades.pop_back(); }, {"state.fades", "149"});
  expect_refused([](auto& s) { s.fades[3] = 1.5; }, {"state.fades[3] is 1.5"});
  expect_refused([](auto& s) { s.fades[4] = std::nan(""); }, {"state.fades[4]"});
  expect_refused([](auto& s) { s.first_faces.push_back(0); }, {"state.first_faces has 151"});
  expect_refused([](auto& s) { s.first_faces[2] = -1; }, {"state.first_faces[2] is -1"});
  expect_refused([](auto& s) { s.first_barycentric[1] = Vec3(2, 0, 0); },
                 {"state.first_barycentric[1]"});
  expect_refused([](auto& s) { s.starts.pop_back(); }, {"state.starts"});
  expect_refused([](auto& s) { s.starts[5] = s.neighbors.size() + 1; }, {"state.starts"});
  expect_refused([](auto& s) { s.neighbors[7] = 150; }, {"state.neighbors[7] is 150"});
  expect_refused([](auto& s) { s.densities.clear(); }, {"state.densities"});
  expect_refused([](auto& s) { s.densities[0] = -1.0; }, {"state.densities"});
  expect_refused([](auto& s) { s.next_id = 100; }, {"state.next_id is 100", "samples.ids[100]"});
  expect_refused([](auto& s) { s.next_id = std::int64_t{1} << 40; }, {"state.next_id"});
  expect_refused([](auto& s) { s.faces_digest += 2; },
                 {"state belongs to a frame with other faces"});
  const Surface other = metaballs(0, 8).surface();
  expect_message<ArgumentError>([&] { population.resume(other, before, good); },
                                {"state belongs to a frame with other faces than the surface's"});
  const auto large = icosphere(5).surface();
  PopulationState unknown = good;
  unknown.faces_digest = 0;
  expect_message<ArgumentError>([&] { population.resume(large, before, unknown); },
                                {"samples.positions[0] is ", "another surface"});
  EXPECT_TRUE(same_places(population.samples(), before));
}

}  // namespace
}  // namespace dapple::test
