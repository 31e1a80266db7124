// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

// A program linked with allocator.cpp uses its allocator for operator new in the whole process and
// for malloc() in the library itself, which Eigen calls.

namespace dapple::test {

/// The number of allocations so far.
[[nodiscard]] long allocations();

/// The number of allocations that have not been freed.
[[nodiscard]] long live_allocations();

/// During its lifetime, the `number`-th allocation from now on, counted from 1, and the `count - 1`
/// after it fail, on any thread.
class OutOfMemory {
 public:
  explicit OutOfMemory(long number, long count = 1);
  ~OutOfMemory();
  OutOfMemory(const OutOfMemory&) = delete;
  OutOfMemory& operator=(const OutOfMemory&) = delete;
};

/// Whether the last OutOfMemory failed first within a call of this short function.
[[nodiscard]] bool was_missing_in(const void* function);

/// Allocations never fail in the shared library that contains this function, except within calls of
/// some short functions.
void spare_library_of(const void* function, std::span<const void* const> except);

/// During its lifetime, records the call stacks of the allocations of one thread.
class CallSites {
 public:
  /// \param most the largest number of allocations that are recorded
  explicit CallSites(long most);
  ~CallSites();
  CallSites(const CallSites&) = delete;
  CallSites& operator=(const CallSites&) = delete;

  /// The first allocation of each different call stack, counted from 1.
  [[nodiscard]] std::vector<long> first_of_each() const;

 private:
  std::vector<std::uint64_t> stacks_;  // of each allocation
};

}  // namespace dapple::test
