// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <dapple/context.hpp>
#include <optional>
#include <vector>

namespace dapple {

/// A stretch of the progress of a piece of work, for a part of it that counts from 0 to 1 by
/// itself; nothing if nobody watches.
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

/// Ask whether to go on, whether anybody watches or only the thread's Poll does.
inline void check_context(const Context* context) {
  if (context) return context->check();
  if (Poll* const poll = Poll::current()) poll->check();
}

/// In the loop over k: ask now and then whether to go on.
inline void check_at(const Context* context, std::size_t k, std::size_t grain = 4096) {
  if (k % grain == 0) check_context(context);
}
inline void check_at(std::size_t k, std::size_t grain = 4096) { check_at(nullptr, k, grain); }

/// The same, and say how far the loop of `count` is.
inline void report_at(Context* context, std::size_t k, std::size_t count,
                      std::size_t grain = 4096) {
  if (k % grain != 0) return;
  check_context(context);
  if (context) context->advance(static_cast<double>(k) / static_cast<double>(count));
}

/// How much of `count` equal things several threads have done.
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

/// Sort, and ask now and then whether to go on; if not, what was to be sorted is lost.
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
