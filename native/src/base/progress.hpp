// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <dapple/context.hpp>
#include <optional>
#include <vector>

namespace dapple {

/// An interval of the progress of some work, for a part that counts from 0 to 1 itself; without a
/// context it does nothing.
class Stretch {
 public:
  Stretch(Context* whole, double from, double to) {
    if (whole) part_.emplace(*whole, from, to);
  }

  /// Step `k` of `count` equal ones of a stretch.
  Stretch(Context* whole, std::size_t k, std::size_t count)
      : Stretch(whole, static_cast<double>(k) / static_cast<double>(count),
                static_cast<double>(k + 1) / static_cast<double>(count)) {}

  [[nodiscard]] Context* context() { return part_ ? &*part_ : nullptr; }

 private:
  std::optional<Context> part_;
};

/// Check for cancellation by the context, or by the thread's Poll.
inline void check_context(const Context* context) {
  if (context) return context->check();
  if (Poll* const poll = Poll::current()) poll->check();
}

/// In a loop over k: check for cancellation at intervals.
inline void check_at(const Context* context, std::size_t k, std::size_t grain = 4096) {
  if (k % grain == 0) check_context(context);
}
inline void check_at(std::size_t k, std::size_t grain = 4096) { check_at(nullptr, k, grain); }

/// The same, and report the progress of the loop over `count`.
inline void report_at(Context* context, std::size_t k, std::size_t count,
                      std::size_t grain = 4096) {
  if (k % grain != 0) return;
  check_context(context);
  if (context) context->advance(static_cast<double>(k) / static_cast<double>(count));
}

/// Progress of several threads that share `count` equal steps.
class Tally {
 public:
  Tally(Context* context, std::size_t count) : context_(context), count_(count) {}

  void check() const { check_context(context_); }
  void add(std::size_t more) {
    const std::size_t done = done_ += more;
    if (context_) context_->advance(static_cast<double>(done) / static_cast<double>(count_));
  }

 private:
  Context* context_;
  std::size_t count_;
  std::atomic<std::size_t> done_ = 0;
};

/// Sort, and check for cancellation at intervals; the values are unspecified after a cancellation.
template <typename T>
void sort_watched(std::vector<T>& values, Context* context) {
  if (!context && !Poll::current()) return std::sort(values.begin(), values.end());
  const auto expected = static_cast<std::size_t>(std::bit_width(values.size())) *
                        std::max<std::size_t>(values.size(), 1);
  std::size_t comparisons = 0;
  std::sort(values.begin(), values.end(), [&](const T& a, const T& b) {
    report_at(context, ++comparisons, expected, 65536);
    return a < b;
  });
}

}  // namespace dapple
