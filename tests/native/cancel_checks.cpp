// SPDX-License-Identifier: GPL-3.0-or-later
#include "cancel_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <mutex>
#include <utility>

namespace dapple::test {

std::atomic<int> checks = 0;
std::atomic<int> cancel_at = kNever;
thread_local std::function<void()> at_next_check;

namespace {

/// The progress of a context at each check while it is watched.
class Watch {
 public:
  void look_at(const Context* context) {
    const std::scoped_lock lock(mutex_);
    context_ = context;
    seen_.clear();
  }
  void note() {
    const std::scoped_lock lock(mutex_);
    if (context_) seen_.push_back(context_->progress());
  }
  [[nodiscard]] const std::vector<double>& seen() const { return seen_; }

 private:
  std::mutex mutex_;
  const Context* context_ = nullptr;
  std::vector<double> seen_;
};

Watch watch;

}  // namespace

int count_checks(const Work& work) {
  Context context;
  checks = 0;
  cancel_at = kNever;
  work(&context);
  return checks;
}

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

std::vector<double> expect_honest_progress(const Work& work, double longest_leap) {
  Context context;
  checks = 0;
  cancel_at = kNever;
  watch.look_at(&context);
  work(&context);
  EXPECT_EQ(context.progress(), 1.0);
  const std::vector<double> seen = watch.seen();
  watch.look_at(nullptr);
  EXPECT_FALSE(seen.empty());
  if (seen.empty()) return seen;
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_LT(seen.back(), 1.0) << "it was said to be done while it worked";
  for (std::size_t k = 1; k < seen.size(); ++k)
    EXPECT_LE(seen[k] - seen[k - 1], longest_leap) << "at check " << k << " of " << seen.size();
  EXPECT_LE(1.0 - seen.back(), longest_leap) << "at the end";
  return seen;
}

}  // namespace dapple::test

extern "C" {
void __real__ZNK6dapple7Context5checkEv(const dapple::Context* context);
void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context);

void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context) {
  using namespace dapple::test;
  watch.note();
  if (++checks == cancel_at) const_cast<dapple::Context*>(context)->cancel();
  if (at_next_check) std::exchange(at_next_check, {})();
  __real__ZNK6dapple7Context5checkEv(context);
}
}
