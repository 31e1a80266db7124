// SPDX-License-Identifier: GPL-3.0-or-later
// The checks of contexts for cancellation, counted and made to cancel. The linker redirects
// Context::check to a function in the source.
#pragma once

#include <atomic>
#include <dapple/context.hpp>
#include <functional>
#include <limits>
#include <vector>

namespace dapple::test {

using Work = std::function<void(Context*)>;

constexpr int kNever = std::numeric_limits<int>::max();
extern std::atomic<int> checks;     ///< number of them since it was set
extern std::atomic<int> cancel_at;  ///< the one that cancels, or kNever

/// The action of this thread at its next check.
extern thread_local std::function<void()> at_next_check;

/// Number of checks of the work.
int count_checks(const Work& work);

/// Run the work once per check and cancel it there; `after` inspects the state.
void cancel_everywhere(const Work& work, const std::function<void()>& after);

/// A frame of `tracked`, or of a copy of `fresh` while nothing is cancelled.
template <typename Tracked, typename Next>
Work advancing(const Tracked& fresh, Tracked& tracked, const Next& next) {
  return [&](Context* context) {
    if (cancel_at == kNever)
      Tracked(fresh).advance(next, context);
    else
      tracked.advance(next, context);
  };
}

/// Check that progress rises without large jumps and reaches 1 only after the last check.
/// \return the progress at each check
std::vector<double> expect_honest_progress(const Work& work, double longest_leap = 0.5);

}  // namespace dapple::test
