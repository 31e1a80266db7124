// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

namespace dapple {

class Stopwatch;

/// Carries cancel and progress between one piece of long work and whoever watches it.
///
/// Every member may be called from any thread. The work never calls back: a watcher polls.
class Context {
 public:
  Context() = default;

  /// For the work: one of a part of it, which counts its own progress from 0 to 1 and with that the
  /// whole's from `from` to `to`. Cancel is one and the same for both. The whole must outlive it.
  Context(Context& whole, double from, double to)
      : stopwatch_(whole.stopwatch_), whole_(&whole), from_(from), to_(to) {}

  /// For the work: one of all of it, with what times its stages. Both must outlive it.
  Context(Context& whole, Stopwatch& stopwatch) : stopwatch_(&stopwatch), whole_(&whole) {}

  /// Ask the work to stop; it then throws Cancelled at its next check.
  void cancel() { whole_ ? whole_->cancel() : cancelled_.store(true); }
  [[nodiscard]] bool cancelled() const { return whole_ ? whole_->cancelled() : cancelled_.load(); }

  /// Share of the work done, in [0, 1]; it never falls.
  [[nodiscard]] double progress() const { return progress_.load(); }

  /// For the work: raise the progress to `value` (a lower value leaves it).
  void advance(double value);

  /// For the work: throw Cancelled if someone asked for it.
  void check() const;

  /// For the work: what times its stages; null if nothing does.
  [[nodiscard]] Stopwatch* stopwatch() const { return stopwatch_; }

 private:
  std::atomic<bool> cancelled_ = false;
  std::atomic<double> progress_ = 0.0;
  Stopwatch* stopwatch_ = nullptr;
  Context* whole_ = nullptr;  // none if this is the whole
  double from_ = 0.0, to_ = 1.0;
};

}  // namespace dapple
