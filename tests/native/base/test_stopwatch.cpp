// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "base/laps.hpp"
#include "base/parallel.hpp"

namespace dapple::test {
namespace {

/// Work that takes a while.
void wait(double seconds = 1e-3) {
  for (const Clock clock; clock.seconds() < seconds;) {
  }
}

TEST(Stopwatch, IsAlwaysInOneStage) {
  const Clock clock;
  Stopwatch stopwatch;
  wait();
  EXPECT_EQ(stopwatch.turn_to(Stage::kCells), Stage::kOther);
  wait();
  EXPECT_EQ(stopwatch.turn_to(Stage::kSolver), Stage::kCells);
  const Profile profile = stopwatch.read();
  EXPECT_GE(profile[Stage::kOther], 1e-3);
  EXPECT_GE(profile[Stage::kCells], 1e-3);
  EXPECT_EQ(profile[Stage::kStart], 0.0);
  EXPECT_LE(profile.total(), clock.seconds());
}

TEST(Stopwatch, CountsTheInnermostStageAndComesBack) {
  Stopwatch stopwatch;
  Context whole;
  Context context(whole, stopwatch);
  const Context part(context, 0.25, 0.5);
  {
    const StageSpan outer(&part, Stage::kSolver);
    wait();
    in_stage(&part, Stage::kCells, [] { wait(4e-3); });
    EXPECT_EQ(stopwatch.turn_to(Stage::kSolver), Stage::kSolver);
  }
  const Profile profile = stopwatch.read();
  EXPECT_GE(profile[Stage::kSolver], 1e-3);
  EXPECT_GE(profile[Stage::kCells], 4e-3);
  EXPECT_EQ(stopwatch.turn_to(Stage::kOther), Stage::kOther);
}

TEST(Stopwatch, KeepsTheSumWhenItCreditsAnotherStage) {
  Stopwatch stopwatch;
  stopwatch.turn_to(Stage::kCells);
  wait();
  stopwatch.credit(Stage::kNeighbors, 4e-4);
  const Profile profile = stopwatch.read();
  EXPECT_EQ(profile[Stage::kNeighbors], 4e-4);
  EXPECT_GE(profile[Stage::kCells], 6e-4);
}

TEST(Stopwatch, IsNeededByNobody) {
  const Context context;
  EXPECT_EQ(context.stopwatch(), nullptr);
  EXPECT_EQ(in_stage(&context, Stage::kCells, [] { return 7; }), 7);
  EXPECT_EQ(in_stage(nullptr, Stage::kCells, [] { return 7; }), 7);
  Laps laps;
  SharedLoop loop(nullptr, Stage::kNeighbors);
  int runs = 0;
  loop.run(0, laps, [&] { ++runs; });
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(laps.stop(), 0.0);
}

TEST(Stopwatch, CarriesProgressAndCancelThrough) {
  Stopwatch stopwatch;
  Context whole;
  Context context(whole, stopwatch);
  context.advance(0.3);
  EXPECT_EQ(whole.progress(), 0.3);
  whole.cancel();
  EXPECT_TRUE(context.cancelled());
}

TEST(Laps, CountOnlyWhileMeasured) {
  Laps laps;
  const auto work = [&] {
    const Laps::Lap lap(laps);
    wait();
  };
  work();
  laps.start();
  work();
  wait();
  const double seconds = laps.stop();
  EXPECT_GE(seconds, 1e-3);
  work();
  EXPECT_EQ(laps.stop(), seconds);
}

TEST(SharedLoop, GivesTheOtherStageItsShareOfTheWallTime) {
  Stopwatch stopwatch;
  Context whole;
  const Context context(whole, stopwatch);
  constexpr std::size_t kBlocks = 24;
  stopwatch.turn_to(Stage::kCells);
  {
    SharedLoop loop(&context, Stage::kNeighbors);
    parallel_chunks(kBlocks, 1, [&](std::size_t block, std::size_t) {
      Laps laps;
      loop.run(block, laps, [&] {
        {
          const Laps::Lap lap(laps);
          wait(5e-4);
        }
        wait(5e-4);
      });
    });
  }
  const Profile profile = stopwatch.read();
  EXPECT_GT(profile[Stage::kNeighbors], 0.0);
  EXPECT_GT(profile[Stage::kCells], 0.0);
  EXPECT_GE(profile.total(), 1e-3);
}

}  // namespace
}  // namespace dapple::test
