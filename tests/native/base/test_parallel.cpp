// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cfenv>
#include <dapple/errors.hpp>
#include <stdexcept>
#include <vector>

#include "base/parallel.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

int concurrency_with(int threads) {
  return with_threads(threads, [] { return tbb::this_task_arena::max_concurrency(); });
}

/// If each call makes an arena, TBB keeps it for a long time when its workers get no processor.
TEST(WithThreads, MakesNoArenaForAllThreads) {
  tbb::task_arena caller(1);
  caller.execute([] {
    EXPECT_EQ(concurrency_with(0), 1);
    EXPECT_EQ(concurrency_with(1), 1);
    EXPECT_EQ(concurrency_with(3), 1);
  });
}

TEST(WithThreads, UsesAtMostTheRequestedThreads) {
  EXPECT_EQ(concurrency_with(0), tbb::this_task_arena::max_concurrency());
  EXPECT_EQ(concurrency_with(1), 1);
  tbb::task_arena caller(3);
  EXPECT_EQ(caller.execute([] { return concurrency_with(2); }), 2);
}

TEST(WithThreads, PassesExceptionsOn) {
  for (const int threads : {0, 1}) {
    const auto work = [] { throw std::runtime_error("from inside"); };
    expect_message<std::runtime_error>([&] { with_threads(threads, work); }, {"from inside"});
  }
  expect_message<ArgumentError>([] { (void)concurrency_with(-1); }, {"threads", "-1"});
}

/// The rounding mode of the caller applies to all workers. If one worker flushed denormal numbers
/// to zero, results would depend on the distribution of the work.
TEST(Parallel, AllThreadsUseTheCallersRounding) {
  for (const int threads : {0, 1}) {
    std::vector<int> modes(64, -1);
    std::fesetround(FE_UPWARD);
    with_threads(threads, [&] {
      parallel_chunks(modes.size(), 1,
                      [&](std::size_t k, std::size_t) { modes[k] = std::fegetround(); });
    });
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(modes, std::vector<int>(modes.size(), FE_UPWARD)) << threads << " threads";
  }
}

TEST(Parallel, SumsAreTheSameForAnyNumberOfThreads) {
  const auto sum = [](int threads) {
    return with_threads(threads, [] {
      return parallel_sum(100'000, 100, [](std::size_t k) { return 1.0 / (1.0 + double(k)); });
    });
  };
  EXPECT_EQ(sum(1), sum(0));
  EXPECT_EQ(sum(1), sum(2));
}

}  // namespace
}  // namespace dapple::test
