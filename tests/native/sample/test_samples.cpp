// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/samples.hpp>
#include <limits>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

struct Binding {
  std::vector<std::int32_t> faces = {0, 3, 7, 7};
  std::vector<Vec3> weights = {{1, 0, 0}, {0.25, 0.5, 0.25}, {0, 0.5, 0.5}, {0.125, 0.125, 0.75}};
  std::vector<std::int32_t> ids = {};
  std::vector<std::int32_t> classes = {};

  [[nodiscard]] Samples bind() const {
    return bind_samples(grid(3).surface(), faces, weights, ids, classes);
  }
  void expect_refused(std::initializer_list<std::string> parts) const {
    expect_message<ArgumentError>([&] { (void)bind(); }, parts);
  }
};

TEST(Samples, StandWhereTheyAreBound) {
  const Samples samples = Binding().bind();
  const Shape shape = grid(3);
  check(shape.surface(), samples);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LE((samples.positions[k] - shape.point(Binding().faces[k], Binding().weights[k])).norm(),
              1e-15);
    EXPECT_LE((samples.normals[k] - Vec3::UnitZ()).norm(), 1e-15);
  }
  EXPECT_EQ(samples.ids, (std::vector<std::int32_t>{0, 1, 2, 3}));
  EXPECT_EQ(samples.classes, (std::vector<std::int32_t>{0, 0, 0, 0}));
}

TEST(Samples, KeepTheirIdsAndClasses) {
  Binding binding;
  binding.ids = {9, -4, 2147483647, 0};
  binding.classes = {1, 0, 1, 2};
  EXPECT_EQ(binding.bind().ids, binding.ids);
  EXPECT_EQ(binding.bind().classes, binding.classes);
}

TEST(Samples, KeepExactWeights) {
  const Samples samples = Binding().bind();
  EXPECT_TRUE(same_bytes(samples.barycentric, Binding().weights));
}

/// Binding bound samples again changes nothing: repeated round trips do not drift.
TEST(Samples, AreTheSameBoundAgain) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  Random random(8);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (int k = 0; k < 2000; ++k) {
    faces.push_back(random.below(static_cast<std::int32_t>(shape.faces.size())));
    weights.push_back(random.weights());
  }
  const Samples once = bind_samples(surface, faces, weights);
  const Samples twice = bind_samples(surface, once.faces, once.barycentric);
  EXPECT_TRUE(same_bytes(twice, once));
}

TEST(Samples, SurviveSinglePrecision) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  Random random(9);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights, rounded;
  for (int k = 0; k < 500; ++k) {
    faces.push_back(random.below(static_cast<std::int32_t>(shape.faces.size())));
    weights.push_back(random.weights());
    rounded.push_back(weights.back().cast<float>().cast<double>());
  }
  const Samples samples = bind_samples(surface, faces, rounded);
  check(surface, samples);
  for (std::size_t k = 0; k < 500; ++k)
    EXPECT_LE((samples.positions[k] - shape.point(faces[k], weights[k])).norm(), 1e-6);
}

TEST(Samples, MayBeNone) { EXPECT_EQ(bind_samples(grid(3).surface(), {}, {}).size(), 0u); }

TEST(Samples, NameTheFirstFaceOutOfRange) {
  for (const std::int32_t bad : {-1, 18, 2147483647}) {
    Binding binding;
    binding.faces[2] = bad;
    binding.faces[3] = -9;
    binding.expect_refused({"faces[2]", std::to_string(bad)});
  }
}

TEST(Samples, NameTheFirstWeightThatIsNotFinite) {
  Binding binding;
  binding.weights[1].y() = std::numeric_limits<double>::quiet_NaN();
  binding.expect_refused({"barycentric[1]", "nan"});
  binding.weights[1].y() = std::numeric_limits<double>::infinity();
  binding.expect_refused({"barycentric[1]", "inf"});
}

TEST(Samples, NameTheFirstNegativeWeight) {
  Binding binding;
  binding.weights[3] = {-0.25, 0.5, 0.75};
  binding.expect_refused({"barycentric[3]", "-0.25"});
}

TEST(Samples, NameTheFirstRowThatDoesNotSumToOne) {
  Binding binding;
  binding.weights[2] = {0.25, 0.25, 0.25};
  binding.expect_refused({"barycentric[2]", "0.75"});
}

TEST(Samples, RefuseIdsThatRepeat) {
  Binding binding;
  binding.ids = {4, 5, 6, 5};
  binding.expect_refused({"ids", "5"});
}

TEST(Samples, RefuseArraysOfDifferentLength) {
  Binding binding;
  binding.weights.pop_back();
  binding.expect_refused({"barycentric", "3", "4"});
  binding = {};
  binding.ids = {1};
  binding.expect_refused({"ids", "1", "4"});
  binding = {};
  binding.classes = {1, 2};
  binding.expect_refused({"classes", "2", "4"});
}

}  // namespace
}  // namespace dapple::test
