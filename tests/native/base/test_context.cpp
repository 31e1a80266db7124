// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <thread>
#include <vector>

namespace dapple::test {
namespace {

TEST(Context, StartsFresh) {
  const Context context;
  EXPECT_FALSE(context.cancelled());
  EXPECT_EQ(context.progress(), 0.0);
  EXPECT_NO_THROW(context.check());
}

TEST(Context, ThrowsOnceCancelled) {
  Context context;
  context.cancel();
  EXPECT_TRUE(context.cancelled());
  EXPECT_THROW(context.check(), Cancelled);
  EXPECT_THROW(context.check(), Cancelled) << "it stays cancelled";
}

TEST(Context, NeverGoesBack) {
  Context context;
  context.advance(0.5);
  context.advance(0.25);
  EXPECT_EQ(context.progress(), 0.5);
}

TEST(Context, CountsAPartWithinItsShare) {
  Context whole;
  Context part(whole, 0.25, 0.75);
  part.advance(0.5);
  EXPECT_EQ(part.progress(), 0.5);
  EXPECT_EQ(whole.progress(), 0.5);
  Context inner(part, 0.5, 1.0);
  inner.advance(0.5);
  EXPECT_EQ(whole.progress(), 0.625);
  inner.advance(1.0);
  EXPECT_EQ(whole.progress(), 0.75);
  EXPECT_EQ(part.progress(), 1.0);
  part.advance(0.1);
  EXPECT_EQ(whole.progress(), 0.75);
}

TEST(Context, CancelsWholeAndPartTogether) {
  Context whole;
  Context part(whole, 0.0, 0.5);
  whole.cancel();
  EXPECT_THROW(part.check(), Cancelled);
  Context other;
  Context(other, 0.0, 1.0).cancel();
  EXPECT_TRUE(other.cancelled());
}

TEST(Context, KeepsTheHighestOfManyThreads) {
  Context context;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&context, t] {
      for (int k = 0; k <= 1000; ++k) context.advance((4 * k + t) / 4003.0);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(context.progress(), 1.0);
}

}  // namespace
}  // namespace dapple::test
