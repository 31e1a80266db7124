// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>

#include "base/stopwatch.hpp"

namespace dapple {

/// A call that has a report: it is timed whether anybody watches it or not.
class TimedCall {
 public:
  /// \param watcher the caller's; null if nobody watches
  explicit TimedCall(Context* watcher) : context_(watcher ? *watcher : nobody_, stopwatch_) {}

  /// For the work.
  [[nodiscard]] Context* context() { return &context_; }

  /// Write the times so far, on top of those of calls before it.
  template <typename AnyReport>
  void write(AnyReport& report, const Profile& before = {}) {
    report.profile = stopwatch_.read();
    for (std::size_t k = 0; k < before.seconds.size(); ++k)
      report.profile.seconds[k] += before.seconds[k];
    report.seconds = report.profile.total();
  }

 private:
  Stopwatch stopwatch_;
  Context nobody_;
  Context context_;
};

}  // namespace dapple
