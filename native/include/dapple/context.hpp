// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <numeric>
#include <thread>

namespace dapple {

/// The stages that a profile divides time into. Where stages are nested, the innermost counts:
/// cells computed during the start count as cells.
enum class Stage {
  kStart,       ///< initial positions
  kNeighbors,   ///< neighbor searches: bounding boxes, queries, bisectors; in flat domains also the
                ///< graph of touching cells
  kCells,       ///< Voronoi cells: clipping, integrals, faces that no flood fill reached
  kSolver,      ///< energy and gradient from the cells, model Hessian, line search, vectors
  kProjection,  ///< projection of moved sites onto the domain
  kReporting,   ///< normals, evenness, bond order
  kOther        ///< checks, densities of classes, deformed surfaces, threads
};

inline constexpr std::array<const char*, 7> kStageNames = {
    "start", "neighbors", "cells", "solver", "projection", "reporting", "other"};

/// Wall time by stage.
struct Profile {
  std::array<double, kStageNames.size()> seconds = {};

  [[nodiscard]] double& operator[](Stage stage) { return seconds[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] double operator[](Stage stage) const {
    return seconds[static_cast<std::size_t>(stage)];
  }
  [[nodiscard]] double total() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
  }
};

class Stopwatch;

/// Lets a program serve its signals or its window while it waits for work. While a Poll exists, all
/// work that its thread starts checks it for cancellation, in addition to its Context.
class Poll {
 public:
  /// \param go_on called in the thread that makes the Poll, at most every 20 ms; returns false to
  /// stop the work. It must not throw. Empty: only stop() stops the work.
  explicit Poll(std::function<bool()> go_on = {});
  ~Poll();
  Poll(const Poll&) = delete;
  Poll& operator=(const Poll&) = delete;

  /// Cancel the work, from any thread; it throws Cancelled at its next check.
  void stop() { stopped_.store(true); }

  /// For the work: throw Cancelled if it has been stopped.
  void check();

  /// For the work: the Poll of this thread; null if there is none.
  [[nodiscard]] static Poll* current();

  /// For the work: while it exists, this thread counts as the one that made the Poll.
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

/// Carries cancellation and progress between a long computation and its observer.
///
/// Every member may be called from any thread. The computation calls back only a Poll; an observer
/// reads progress() when it likes.
class Context {
 public:
  Context() = default;

  /// For the work: the context of a part, whose progress from 0 to 1 raises that of the whole from
  /// `from` to `to`. Both share cancellation. The whole must outlive the part.
  Context(Context& whole, double from, double to)
      : stopwatch_(whole.stopwatch_), whole_(&whole), from_(from), to_(to) {}

  /// For the work: the same context with a stopwatch for its stages. Both must outlive it.
  Context(Context& whole, Stopwatch& stopwatch) : stopwatch_(&stopwatch), whole_(&whole) {}

  /// Cancel the work; it throws Cancelled at its next check.
  void cancel();
  [[nodiscard]] bool cancelled() const;

  /// Share of the work done, in [0, 1]; it never falls.
  [[nodiscard]] double progress() const { return progress_.load(); }

  /// For the work: raise the progress to `value`, at most to 1 (a lower value or NaN leaves it).
  void advance(double value);

  /// For the work: throw Cancelled if this context or the thread's Poll has been cancelled.
  void check() const;

  /// For the work: the stopwatch of its stages; null if there is none.
  [[nodiscard]] Stopwatch* stopwatch() const { return stopwatch_; }

 private:
  std::atomic<bool> cancelled_ = false;
  std::atomic<double> progress_ = 0.0;
  Stopwatch* stopwatch_ = nullptr;
  Context* whole_ = nullptr;  // none if this is the whole
  double from_ = 0.0, to_ = 1.0;
};

}  // namespace dapple
