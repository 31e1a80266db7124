// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/option.hpp>
#include <functional>
#include <span>
#include <vector>

#include "base/hand_over.hpp"

#ifdef _WIN32  // macros of a system header that TBB includes
#undef near
#undef far
#undef small
#endif

namespace dapple {

/// Run `body(begin, end)` over [0, count) in chunks of `grain`, whose bounds do not depend on the
/// number of threads: what a chunk computes into its own slots is then the same for any number of
/// them. The caller's Poll is called between chunks.
/// \throw Cancelled
template <typename Body>
void parallel_chunks(std::size_t count, std::size_t grain, const Body& body) {
  const std::size_t chunks = (count + grain - 1) / grain;
  if (chunks <= 1) {
    if (count > 0) body(std::size_t{0}, count);
    return;
  }
  // All threads use the caller's rounding mode. Otherwise they inherit the mode of the thread that
  // started TBB, where Embree flushes denormal numbers to zero.
  using Group = tbb::task_group_context;
  Group group(Group::bound, Group::default_traits | Group::fp_settings);
  Poll* const poll = Poll::current();
  HandOver all;  // last, because later writes are not handed over
  const auto visit = [&](const auto& range) {
    const HandOver::Part part(all);
    const Poll::Share share(poll);
    for (std::size_t chunk = range.begin(); chunk != range.end(); ++chunk) {
      if (poll) poll->check();
      body(chunk * grain, std::min(count, (chunk + 1) * grain));
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks, 1), visit, group);
}

/// Compares two values, and calls a Poll for some addresses.
template <typename Less>
struct PolledLess {
  Less less;
  Poll* poll;

  template <typename T>
  bool operator()(const T& a, const T& b) const {
    if (poll && (reinterpret_cast<std::uintptr_t>(&a) & 0x3ffffU) < sizeof(T)) poll->check();
    return less(a, b);
  }
};

/// Sort distinct values, so that the order does not depend on the number of threads.
/// \throw Cancelled by the caller's Poll; the values are then unspecified
template <typename T, typename Less = std::less<>>
void parallel_sort(std::vector<T>& values, const Less& compare = {}) {
  const PolledLess<Less> less{compare, Poll::current()};
#ifdef DAPPLE_THREAD_SANITIZER  // it does not know the synchronization of oneTBB's sort
  std::sort(values.begin(), values.end(), less);
#else
  tbb::parallel_sort(values.begin(), values.end(), less);
#endif
}

/// The sum of term(k) over [0, count), added up by chunks of `grain`, whose sums are added up in
/// order: the same for any number of threads.
template <typename Term>
double parallel_sum(std::size_t count, std::size_t grain, const Term& term) {
  const std::size_t chunks = (count + grain - 1) / grain;
  std::array<double, 256> few;  // without an allocation
  std::vector<double> many(chunks > few.size() ? chunks : 0);
  const std::span<double> sums = many.empty() ? std::span(few).first(chunks) : std::span(many);
  parallel_chunks(count, grain, [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) sum += term(k);
    sums[begin / grain] = sum;
  });
  double total = 0.0;
  for (const double sum : sums) total += sum;
  return total;
}

/// Run `work()` with at most `threads` threads (0: as many as the machine has), apart from what
/// else the caller's threads do.
/// \throw ArgumentError unless they are in 0..kMostThreads
// An arena is created only for fewer threads than the machine has: oneTBB 2021.8 (Debian 12) keeps
// the arenas of calls that end while no worker gets a processor, and its workers search all of them
// for work. On a busy machine many short calls then need ever more memory and twice the time.
template <typename Work>
auto with_threads(int threads, const Work& work) {
  check_range("threads", threads, {0.0, kMostThreads});
  if (threads == 0 || threads >= tbb::this_task_arena::max_concurrency())
    return tbb::this_task_arena::isolate(work);
  tbb::task_arena arena(threads);
  return arena.execute(work);
}

}  // namespace dapple
