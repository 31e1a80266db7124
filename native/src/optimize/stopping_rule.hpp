// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace dapple {

/// When a minimization ends: after decreases that are too small several times in a row, or after
/// steps in a row that lowered nothing.
class StoppingRule {
 public:
  /// \param tolerance relative decrease that is not small
  /// \param patience small ones in a row that end it
  /// \param failures steps without any decrease in a row that end it
  StoppingRule(double tolerance, int patience, int failures)
      : tolerance_(tolerance), patience_(patience), most_failures_(failures) {}

  /// After a step.
  /// \param decrease relative; of a failed step, the possible decrease
  /// \param promised by the step, relative
  /// \param sure whether the promise is to be trusted: if it was small too, the next step would
  ///             decrease it even less, so that this one ends it
  void update(double decrease, bool found, double promised, bool sure = false) {
    small_ = decrease > tolerance_ ? 0 : small_ + 1;
    if (sure && small_ > 0 && promised <= kNearly * tolerance_)
      small_ = std::max(small_, patience_);
    failures_ = found ? 0 : failures_ + 1;
    missed_ = found ? 0.0 : std::max(missed_, promised);
  }

  /// Forget previous steps.
  void reset() { small_ = failures_ = 0, missed_ = 0.0; }

  [[nodiscard]] bool decreases_are_small() const { return small_ >= patience_; }
  [[nodiscard]] bool steps_fail() const { return failures_ >= most_failures_; }
  [[nodiscard]] bool ends() const { return decreases_are_small() || steps_fail(); }

  /// Whether the last step failed.
  [[nodiscard]] bool failed() const { return failures_ > 0; }
  /// The largest relative decrease predicted by the failed steps in a row.
  [[nodiscard]] double missed() const { return missed_; }

 private:
  static constexpr double kNearly = 1.5;  // times the tolerance: a small promise

  double tolerance_;
  int patience_, most_failures_;
  int small_ = 0, failures_ = 0;  // in a row
  double missed_ = 0.0;
};

}  // namespace dapple
