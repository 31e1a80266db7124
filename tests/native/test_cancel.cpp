// SPDX-License-Identifier: GPL-3.0-or-later
// Cancels a piece of work at every place where it asks whether to go on: count first, then break
// each one (as Embree's verify does with allocations). The linker puts the function below before
// Context::check.
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <functional>
#include <limits>
#include <thread>

#include "invariants.hpp"
#include "shapes.hpp"

namespace {

constexpr int kNever = std::numeric_limits<int>::max();
std::atomic<int> checks = 0;
std::atomic<int> cancel_at = kNever;

}  // namespace

extern "C" {
void __real__ZNK6dapple7Context5checkEv(const dapple::Context* context);
void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context);

void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context) {
  if (++checks == cancel_at) const_cast<dapple::Context*>(context)->cancel();
  __real__ZNK6dapple7Context5checkEv(context);
}
}

namespace dapple::test {
namespace {

using Work = std::function<void(Context*)>;

int count_checks(const Work& work) {
  Context context;
  checks = 0;
  cancel_at = kNever;
  work(&context);
  return checks;
}

/// Run the work once for each of its checks, cancelled there; `after` looks at what is left.
void cancel_everywhere(const Work& work, const std::function<void()>& after) {
  const int total = count_checks(work);
  std::cout << total << " checks\n";
  ASSERT_GT(total, 3) << "the work hardly ever asks";
  for (int k = 1; k <= total; ++k) {
    Context context;
    checks = 0;
    cancel_at = k;
    EXPECT_THROW(work(&context), Cancelled) << "at check " << k << " of " << total;
    EXPECT_GE(context.progress(), 0.0);
    EXPECT_LE(context.progress(), 1.0);
    after();
    if (testing::Test::HasFailure()) return;
  }
  cancel_at = kNever;
}

SampleOptions few_evaluations(int threads) {
  SampleOptions options;
  options.optimizer.max_evaluations = 6;
  options.threads = threads;
  return options;
}

class CancelWithThreads : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Threads, CancelWithThreads, testing::Values(1, 2));

TEST_P(CancelWithThreads, EverywhereInASample) {
  const Surface surface = two_sheets(4, 0.02).surface();  // with orphans, so that all passes run
  const SampleOptions options = few_evaluations(GetParam());
  const Samples expected = sample(surface, 120, options);
  cancel_everywhere([&](Context* context) { (void)sample(surface, 120, options, context); }, [] {});
  EXPECT_TRUE(same_bytes(sample(surface, 120, options), expected))
      << "a cancelled run left something behind";
}

TEST_P(CancelWithThreads, EverywhereInATrackedFrame) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const std::vector<Vec3> next = deformed(shape.vertices, 0.8);
  TrackerOptions options;
  options.threads = GetParam();
  options.optimizer.max_evaluations = 6;
  const Samples samples = sample(surface, 120);
  const Tracker fresh(surface, samples, options);
  Tracker tracker = fresh;
  cancel_everywhere(
      [&](Context* context) {
        if (cancel_at == kNever)
          Tracker(fresh).advance(next, context);
        else
          tracker.advance(next, context);
      },
      [&] {
        EXPECT_TRUE(same_bytes(tracker.samples(), fresh.samples()));
        EXPECT_TRUE(same_bytes(tracker.surface().vertices(), shape.vertices));
      });
  Tracker untouched = fresh;
  EXPECT_TRUE(same_bytes(tracker.advance(next), untouched.advance(next)));
}

TEST(Cancel, EverywhereInAPoissonStart) {
  const Surface surface = blob(3).surface();
  const SampleOptions options = [] {
    SampleOptions only_start;
    only_start.optimizer.max_evaluations = 1;
    return only_start;
  }();
  cancel_everywhere([&](Context* context) { (void)sample(surface, 2000, options, context); },
                    [] {});
}

/// From another thread, with hundreds of evaluations still to go.
TEST(Cancel, FromAnotherThreadWhileItWorks) {
  const Surface surface = blob(4).surface();
  SampleOptions options;
  options.optimizer.tolerance = 0.0;
  options.optimizer.max_evaluations = 500;
  cancel_at = kNever;
  for (const double when : {0.0, 0.01, 0.05, 0.2}) {
    Context context;
    std::jthread watcher([&] {
      while (context.progress() < when) std::this_thread::yield();
      context.cancel();
    });
    EXPECT_THROW((void)sample(surface, 2000, options, &context), Cancelled)
        << "at progress " << when;
  }
}

TEST(Cancel, ProgressNeverFalls) {
  const Surface surface = blob(4).surface();
  cancel_at = kNever;
  Context context;
  std::vector<double> seen;
  {
    std::jthread watcher([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const double now = context.progress();
        if (seen.empty() || now != seen.back()) seen.push_back(now);
        std::this_thread::yield();
      }
    });
    (void)sample(surface, 2000, {}, &context);
  }
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GT(seen.size(), 3u) << "progress hardly moves";
  EXPECT_EQ(context.progress(), 1.0);
}

}  // namespace
}  // namespace dapple::test
