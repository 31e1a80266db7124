// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/random.hpp"

namespace dapple::test {
namespace {

/// The first numbers of SplitMix64 with seed 0, from the code of its authors.
TEST(Random, IsSplitMix64) {
  Random random(0);
  EXPECT_EQ(random.bits(), 0xe220a8397b1dcdafu);
  EXPECT_EQ(random.bits(), 0x6e789e6aa1b965f4u);
  EXPECT_EQ(random.bits(), 0x06c45d188009454fu);
}

TEST(Random, KnowsItsNumbersAhead) {
  Random random(7);
  const Random before = random;
  for (std::uint64_t k = 0; k < 100; ++k) {
    EXPECT_EQ(random, before.after(k));
    Random ahead = before.after(k);
    EXPECT_EQ(ahead.uniform(), random.uniform());
  }
  EXPECT_FALSE(random == before);
}

}  // namespace
}  // namespace dapple::test
