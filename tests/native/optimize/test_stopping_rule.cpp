// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "optimize/stopping_rule.hpp"

namespace dapple::test {
namespace {

TEST(StoppingRule, EndsAfterSmallDecreasesInARow) {
  StoppingRule rule(/*tolerance=*/0.1, /*patience=*/2, /*failures=*/5);
  rule.update(0.05, true, 0.0);
  EXPECT_FALSE(rule.ends());
  rule.update(0.5, true, 0.0);
  rule.update(0.1, true, 0.0);  // equal to the tolerance
  EXPECT_FALSE(rule.ends()) << "a large one was between";
  rule.update(0.1, true, 0.0);
  EXPECT_TRUE(rule.decreases_are_small());
  EXPECT_FALSE(rule.steps_fail());
}

TEST(StoppingRule, EndsWhereASureStepDecreasesLittle) {
  StoppingRule rule(0.1, 2, 5);
  rule.update(0.11, true, 0.0, /*sure=*/true);
  rule.update(0.1, true, 0.0, /*sure=*/false);
  EXPECT_FALSE(rule.ends());
  rule.update(0.11, true, 0.1, /*sure=*/true);
  rule.update(0.1, true, 0.2, /*sure=*/true);
  EXPECT_FALSE(rule.ends()) << "more was promised";
  rule.update(0.11, true, 0.1, /*sure=*/true);
  rule.update(0.1, true, 0.1, /*sure=*/true);
  EXPECT_TRUE(rule.decreases_are_small());
}

TEST(StoppingRule, EndsAfterFailuresInARowAndKeepsTheirLargestPrediction) {
  StoppingRule rule(0.1, 9, 2);
  rule.update(0.5, false, 0.3);
  rule.update(0.5, true, 0.0);
  EXPECT_EQ(rule.missed(), 0.0);
  rule.update(0.5, false, 0.4);
  rule.update(0.5, false, 0.2);
  EXPECT_TRUE(rule.steps_fail());
  EXPECT_TRUE(rule.failed());
  EXPECT_EQ(rule.missed(), 0.4);
  rule.reset();
  EXPECT_FALSE(rule.ends());
  EXPECT_FALSE(rule.failed());
  EXPECT_EQ(rule.missed(), 0.0);
}

}  // namespace
}  // namespace dapple::test
