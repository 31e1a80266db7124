// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>

#include "base/clock.hpp"

namespace dapple {

/// Times the stages of one piece of work. It is always in one of them, so their times sum to the
/// total. Only the thread that does the work may use it, not threads that share its loops.
class Stopwatch {
 public:
  /// Go over to a stage.
  /// \return the one so far
  Stage turn_to(Stage stage);

  /// Move seconds from the present stage to another.
  void credit(Stage stage, double seconds);

  /// The times so far.
  [[nodiscard]] Profile read();

 private:
  Clock clock_;
  double last_ = 0.0;
  Stage stage_ = Stage::kOther;
  Profile profile_;
};

/// Puts the work in a stage during its lifetime.
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

/// Runs `work()` in a stage and returns its result.
template <typename Work>
auto in_stage(const Context* context, Stage stage, const Work& work) {
  const StageSpan span(context, stage);
  return work();
}

}  // namespace dapple
