// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>
#include <optional>

#include "base/clock.hpp"
#include "base/stopwatch.hpp"

namespace dapple {

/// Times the parts of a thread's work that belong to another stage, if profiling is requested.
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

/// A parallel loop in which two stages alternate many times per block. A few blocks are timed by
/// the threads that run them, and the other stage gets its share of the loop's wall time. The
/// destructor ends the measurement.
class SharedLoop {
 public:
  SharedLoop(const Context* context, Stage other)
      : stopwatch_(context ? context->stopwatch() : nullptr), other_(other) {}
  ~SharedLoop();
  SharedLoop(const SharedLoop&) = delete;
  SharedLoop& operator=(const SharedLoop&) = delete;

  /// Run a block, in which `laps` times the other stage. Any thread may call it.
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
