// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/random.hpp"
#include "voronoi/half_spaces.hpp"

namespace dapple::test {
namespace {

Vec3 random_vector(Random& random) {
  return {random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5};
}

TEST(HalfSpaces, AreComparedAlikeByEveryInstructionSet) {
  constexpr std::size_t kCount = 3 * HalfSpaces::kBlock;
  Random random(1);
  for (int round = 0; round < 2000; ++round) {
    const std::array<Vec3, 3> corners = {random_vector(random), random_vector(random),
                                         random_vector(random)};
    const HalfSpaces::Triangle triangle = {Triple(corners[0]), Triple(corners[1]),
                                           Triple(corners[2])};
    std::vector<Vec3> normals(kCount);
    std::vector<double> offsets(kCount);
    for (std::size_t k = 0; k < kCount; ++k) {
      normals[k] = random_vector(random);
      // The plane passes through a corner: the last bit of a sum matters.
      offsets[k] = corners[k % 3].dot(normals[k]);
    }
    const double floor = round % 2 == 0 ? 0.0 : -1e-17;
    for (const InstructionSet set : instruction_sets()) {
      HalfSpaces half_spaces(set);
      for (std::size_t k = 0; k < kCount; ++k) half_spaces.assign(k, normals[k], offsets[k]);
      for (std::size_t k = 0; k < kCount; ++k) {
        bool reached = false;
        for (const Vec3& corner : corners)
          reached = reached || corner.dot(normals[k]) - offsets[k] >= floor;
        const std::size_t lane = k % HalfSpaces::kBlock;
        const unsigned bits = half_spaces.reached_by(k - lane, triangle, floor);
        EXPECT_EQ(((bits >> lane) & 1U) != 0, reached) << name_of(set) << ", half-space " << k;
      }
    }
  }
}

}  // namespace
}  // namespace dapple::test
