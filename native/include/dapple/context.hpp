// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

namespace dapple {

/// Carries cancel and progress between one piece of long work and whoever watches it.
///
/// Every member may be called from any thread. The work never calls back: a watcher polls.
class Context {
 public:
  /// Ask the work to stop; it then throws Cancelled at its next check.
  void cancel() { cancelled_.store(true); }
  [[nodiscard]] bool cancelled() const { return cancelled_.load(); }

  /// Share of the work done, in [0, 1]; it never falls.
  [[nodiscard]] double progress() const { return progress_.load(); }

  /// For the work: raise the progress to `value` (a lower value leaves it).
  void advance(double value);

  /// For the work: throw Cancelled if someone asked for it.
  void check() const;

 private:
  std::atomic<bool> cancelled_ = false;
  std::atomic<double> progress_ = 0.0;
};

}  // namespace dapple
