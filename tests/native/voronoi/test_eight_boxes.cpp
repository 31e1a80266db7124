// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "voronoi/eight_boxes.hpp"

namespace dapple::test {
namespace {

TEST(EightBoxes, AreComparedAlikeByEveryInstructionSet) {
  Random random(3);
  const auto draw = [&] { return random.uniform() - 0.5; };
  for (int round = 0; round < 2000; ++round) {
    Eight low, high;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t k = 0; k < 8; ++k) {
        low[axis][k] = draw();
        high[axis][k] = low[axis][k] + (round % 3 == 0 ? 0.0 : 0.2 * random.uniform());
      }
    const Vec3 corner(draw(), draw(), draw());
    const Box query = {corner, corner + Vec3::Constant(0.1 * (round % 2))};
    const std::array<double, 8> distances = squared_distances(low, high, query);
    // the limit equals a distance, so the last bit matters
    const double limit = distances[static_cast<std::size_t>(round) % 8];
    for (const InstructionSet set : instruction_sets()) {
      const unsigned bits = compare_boxes(set)(low, high, query, limit);
      for (std::size_t k = 0; k < 8; ++k)
        EXPECT_EQ(((bits >> k) & 1U) != 0, distances[k] < limit) << name_of(set) << ", box " << k;
    }
  }
}

TEST(EightBoxes, AreAsFarAsTheirNearestPoints) {
  Eight low, high;
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) {  // unit cubes, translated along one axis or two
      low[axis][k] = axis == k % 3 || axis == k % 2 ? static_cast<double>(k) : 0.0;
      high[axis][k] = low[axis][k] + 1.0;
    }
  const std::array<double, 8> found = squared_distances(low, high, {Vec3::Zero(), Vec3::Ones()});
  for (std::size_t k = 0; k < 8; ++k) {
    const double gap = k == 0 ? 0.0 : static_cast<double>(k) - 1.0;
    EXPECT_EQ(found[k], (k % 3 == k % 2 ? 1.0 : 2.0) * gap * gap) << k;
  }
}

TEST(EightBoxes, ThatAreMissingAreFar) {
  Eight low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis].fill(std::numeric_limits<double>::infinity());
    high[axis].fill(-std::numeric_limits<double>::infinity());
  }
  const Box query = {Vec3::Zero(), Vec3::Ones()};
  for (const InstructionSet set : instruction_sets()) {
    EXPECT_EQ(compare_boxes(set)(low, high, query, 1e300), 0U) << name_of(set);
    EXPECT_EQ(compare_boxes(set)(low, low, query, 1e300), 0U) << name_of(set);
  }
}

TEST(EightBoxes, NothingIsNearWhatIsNoNumber) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Eight points;
  for (std::size_t axis = 0; axis < 3; ++axis) points[axis].fill(0.0);
  for (const Vec3& place : {Vec3(kNone, 0.0, 0.0), Vec3(0.0, kNone, 0.0), Vec3(0.0, 0.0, kNone)})
    for (const InstructionSet set : instruction_sets())
      EXPECT_EQ(compare_boxes(set)(points, points, {place, place}, 1e300), 0U) << name_of(set);
}

}  // namespace
}  // namespace dapple::test
