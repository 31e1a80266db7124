// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "optimize/forecast.hpp"

namespace dapple::test {
namespace {

TEST(Forecast, FindsTheEndOfDecreasesThatFollowItsLaw) {
  OptimizerOptions options;
  options.tolerance = 1e-5;
  Forecast forecast(options, options.tolerance, /*restoring=*/false);
  const double c = 0.1;  // the energy decreases like c / k^2, which meets the tolerance at k = 100
  for (int k = 1; k <= 10; ++k) forecast.note(k, c / (k * k));
  EXPECT_NEAR(forecast.evaluations(), 100.0, 1e-6);
  EXPECT_NEAR(forecast.progress(10), 0.1, 1e-9);
}

TEST(Forecast, NeverExceedsTheEvaluationLimit) {
  OptimizerOptions options;
  options.max_evaluations = 6;
  options.tolerance = 0.0;
  EXPECT_EQ(expected_evaluations(options), 6.0);
  options.max_evaluations = 200;
  EXPECT_LE(Forecast(options, options.tolerance, /*restoring=*/true).evaluations(), 4.0);
}

TEST(Forecast, ProgressRisesBeyondWhatWasExpectedAndStaysBelowOne) {
  const OptimizerOptions options;
  const Forecast forecast(options, options.tolerance, /*restoring=*/false);
  const int expected = static_cast<int>(forecast.evaluations());
  double before = 0.0;
  for (int k = 1; k <= 3 * expected; ++k) {
    const double progress = forecast.progress(k);
    EXPECT_GT(progress, before);
    EXPECT_LT(progress, 1.0);
    before = progress;
  }
}

}  // namespace
}  // namespace dapple::test
