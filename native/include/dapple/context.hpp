// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

namespace dapple {

class Stopwatch;

/// Lets a program serve its signals or its window while it waits for work. While a Poll lives, all
/// work that its thread begins asks it whether to go on, whatever its Context.
class Poll {
 public:
  /// \param go_on called now and then in the thread that makes this, at most every 20 ms; false
  /// stops the work. It must not throw. Empty: only stop() does.
  explicit Poll(std::function<bool()> go_on = {});
  ~Poll();
  Poll(const Poll&) = delete;
  Poll& operator=(const Poll&) = delete;

  /// Ask the work to stop, from any thread; it then throws Cancelled at its next check.
  void stop() { stopped_.store(true); }

  /// For the work: throw Cancelled if it is to stop.
  void check();

  /// For the work: the one of this thread; null if there is none.
  [[nodiscard]] static Poll* current();

  /// For the work: while it lives, this thread works for the one that made the poll.
  class Share {
   public:
    explicit Share(Poll* poll);
    ~Share();
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    Poll* before_;
  };

 private:
  using Clock = std::chrono::steady_clock;

  void ask();

  std::function<bool()> go_on_;
  std::thread::id thread_ = std::this_thread::get_id();
  Clock::time_point next_;
  bool asking_ = false;  // go_on() may work itself
  std::atomic<bool> stopped_ = false;
  Poll* before_;  // of the same thread
};

/// Carries cancel and progress between one piece of long work and whoever watches it.
///
/// Every member may be called from any thread. The work calls nobody but a Poll: a watcher looks.
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
  void cancel();
  [[nodiscard]] bool cancelled() const;

  /// Share of the work done, in [0, 1]; it never falls.
  [[nodiscard]] double progress() const { return progress_.load(); }

  /// For the work: raise the progress to `value`, at most to 1 (a lower value or NaN leaves it).
  void advance(double value);

  /// For the work: throw Cancelled if someone asked for it, here or by the thread's Poll.
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
