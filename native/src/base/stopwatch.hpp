// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>

#include "base/clock.hpp"

namespace dapple {

/// Times the stages of one piece of work. It always is in one of them, so that they sum to the
/// whole. Only the thread that does the work may use it, not those that it shares loops with.
class Stopwatch {
 public:
  /// Go over to a stage.
  /// \return the one so far
  Stage turn_to(Stage stage);

  /// Count seconds of the present stage as of another.
  void credit(Stage stage, double seconds);

  /// The times so far.
  [[nodiscard]] Profile read();

 private:
  Clock clock_;
  double last_ = 0.0;
  Stage stage_ = Stage::kOther;
  Profile profile_;
};

/// While it lives, the work is in a stage.
class StageSpan {
 public:
  /// \param context nothing happens if it is null, or times nothing
  StageSpan(const Context* context, Stage stage)
      : stopwatch_(context ? context->stopwatch() : nullptr) {
    if (stopwatch_) before_ = stopwatch_->turn_to(stage);
  }
  ~StageSpan() {
    if (stopwatch_) stopwatch_->turn_to(before_);
  }
  StageSpan(const StageSpan&) = delete;
  StageSpan& operator=(const StageSpan&) = delete;

 private:
  Stopwatch* stopwatch_;
  Stage before_ = Stage::kOther;
};

/// What `work()` returns, done in a stage.
template <typename Work>
auto in_stage(const Context* context, Stage stage, const Work& work) {
  const StageSpan span(context, stage);
  return work();
}

}  // namespace dapple
