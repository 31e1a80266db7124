// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <optional>

#include "base/clock.hpp"
#include "base/stopwatch.hpp"

namespace dapple {

/// The parts of a thread's work that are of another stage than the rest, while someone asks.
class Laps {
 public:
  /// One such part; they do not nest.
  class Lap {
   public:
    explicit Lap(Laps& laps) : laps_(&laps) {
      if (laps.running_) clock_.emplace();
    }
    ~Lap() {
      if (clock_) laps_->seconds_ += clock_->seconds();
    }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;

   private:
    Laps* laps_;
    std::optional<Clock> clock_;
  };

  void start() {
    running_ = true;
    seconds_ = 0.0;
  }
  /// \return seconds of all parts since the start
  double stop() {
    running_ = false;
    return seconds_;
  }

 private:
  bool running_ = false;
  double seconds_ = 0.0;
};

/// A parallel loop in which work of the present stage and of another take turns many times a block.
/// A few of the blocks are timed, each by the thread that runs it, and the other stage gets that
/// share of the loop's wall time. Ends with its life.
class SharedLoop {
 public:
  SharedLoop(const Context* context, Stage other)
      : stopwatch_(context ? context->stopwatch() : nullptr), other_(other) {}
  ~SharedLoop();
  SharedLoop(const SharedLoop&) = delete;
  SharedLoop& operator=(const SharedLoop&) = delete;

  /// Do a block's work, of which `laps` time what is of the other stage. Any thread may.
  template <typename Work>
  void run(std::size_t block, Laps& laps, const Work& work) {
    if (!stopwatch_ || block % kEvery != 0) return work();
    const Clock clock;
    laps.start();
    work();
    add(laps.stop(), clock.seconds());
  }

 private:
  static constexpr std::size_t kEvery = 8;  // looks at the clock take 1 to 3 % of a cell

  void add(double in_other, double in_all);

  Stopwatch* stopwatch_;
  Stage other_;
  Clock clock_;
  std::mutex adding_;
  double in_other_ = 0.0, in_all_ = 0.0;
};

}  // namespace dapple
