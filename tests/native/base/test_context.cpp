// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <limits>
#include <thread>
#include <vector>

#include "base/parallel.hpp"

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

TEST(Context, IsDoneAtOne) {
  Context context;
  context.advance(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(context.progress(), 0.0);
  context.advance(std::numeric_limits<double>::infinity());
  EXPECT_EQ(context.progress(), 1.0);
}

TEST(Poll, IsCalledAtIntervalsInItsOwnThread) {
  int asked = 0;
  Poll poll([&] { return ++asked < 2; });
  const Context context;
  context.check();
  EXPECT_EQ(asked, 0) << "not at once";
  std::thread([&] {
    const Poll::Share share(&poll);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    context.check();
  }).join();
  EXPECT_EQ(asked, 0) << "of another thread";
  context.check();
  EXPECT_EQ(asked, 1);
  context.check();
  EXPECT_EQ(asked, 1) << "so soon after";
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_THROW(context.check(), Cancelled);
  EXPECT_FALSE(context.cancelled()) << "the context serves whoever comes next";
}

TEST(Poll, StopsWhatItsThreadBeginsWhileItLives) {
  const Context context;
  {
    Poll outer;
    {
      Poll inner;
      inner.stop();
      EXPECT_THROW(context.check(), Cancelled);
    }
    EXPECT_EQ(Poll::current(), &outer);
    EXPECT_NO_THROW(context.check());
    std::thread([&] { EXPECT_EQ(Poll::current(), nullptr); }).join();
  }
  EXPECT_EQ(Poll::current(), nullptr);
}

TEST(Poll, StopsLoopsWithoutAContext) {
  Poll poll;
  poll.stop();
  std::atomic<int> chunks = 0;
  EXPECT_THROW(parallel_chunks(100, 1, [&](std::size_t, std::size_t) { ++chunks; }), Cancelled);
  EXPECT_EQ(chunks, 0);
}

TEST(Poll, MayWorkItself) {
  Context context;
  Poll poll([&] {
    context.check();
    return true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_NO_THROW(context.check());
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
