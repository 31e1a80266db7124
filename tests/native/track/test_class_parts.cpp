// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/sampler.hpp>

#include "shapes.hpp"
#include "track/class_parts.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 12;

/// Samples of two classes that alternate.
Samples alternating(const Surface& surface) {
  const Samples samples = sample(surface, kCount);
  std::vector<std::int32_t> ids, classes;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(kCount); ++k) {
    ids.push_back(100 + k);
    classes.push_back(k % 2);
  }
  return bind_samples(surface, samples.faces, samples.barycentric, ids, classes);
}

TEST(ClassParts, AreTheSamplesOfOneClassInTheirOrder) {
  const Surface surface = blob(2).surface();
  const Samples all = alternating(surface);
  for (const std::int32_t c : {0, 1}) {
    const Samples part = of_class(surface, all, c);
    ASSERT_EQ(part.size(), kCount / 2);
    for (std::size_t k = 0; k < part.size(); ++k) {
      const std::size_t of_all = 2 * k + static_cast<std::size_t>(c);
      EXPECT_EQ(part.ids[k], all.ids[of_all]);
      EXPECT_EQ(part.faces[k], all.faces[of_all]);
      EXPECT_EQ(part.positions[k], all.positions[of_all]);
    }
  }
}

TEST(ClassParts, AreJoinedInTheOrderThatSamplesHadAndNewOnesComeLast) {
  const Surface surface = blob(2).surface();
  const Samples all = alternating(surface);
  std::vector<Samples> parts = {of_class(surface, all, 0), of_class(surface, all, 1)};
  parts[0].ids[3] = 500;  // a new sample
  const Samples found = joined(surface, all, parts);
  std::vector<std::int32_t> expected = all.ids, classes = all.classes;
  const std::ptrdiff_t gone = 6;  // the fourth of class 0
  expected.erase(expected.begin() + gone);
  expected.push_back(500);
  classes.erase(classes.begin() + gone);
  classes.push_back(0);
  EXPECT_EQ(found.ids, expected);
  EXPECT_EQ(found.classes, classes);
  EXPECT_EQ(found.faces.back(), all.faces[gone]);
  EXPECT_EQ(found.positions.front(), all.positions.front());
}

}  // namespace
}  // namespace dapple::test
