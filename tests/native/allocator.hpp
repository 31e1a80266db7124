// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

// A program with allocator.cpp allocates by it: operator new of everything in the process, and the
// malloc() of the library itself, which Eigen calls.

namespace dapple::test {

/// So far.
[[nodiscard]] long allocations();

/// How many have not been freed.
[[nodiscard]] long live_allocations();

/// During its life the `number`-th allocation from now on, counted from 1, and the `count - 1`
/// after it find no memory, whichever thread asks.
class OutOfMemory {
 public:
  explicit OutOfMemory(long number, long count = 1);
  ~OutOfMemory();
  OutOfMemory(const OutOfMemory&) = delete;
  OutOfMemory& operator=(const OutOfMemory&) = delete;
};

/// Whether the last OutOfMemory began within a call of this short function.
[[nodiscard]] bool was_missing_in(const void* function);

/// Memory is never missing in the shared library that this function is of, except within calls of
/// some short functions.
void spare_library_of(const void* function, std::span<const void* const> except);

/// During its life tells the calls of functions apart that lead to allocations, of one thread.
class CallSites {
 public:
  /// \param most how many allocations are looked at
  explicit CallSites(long most);
  ~CallSites();
  CallSites(const CallSites&) = delete;
  CallSites& operator=(const CallSites&) = delete;

  /// The first allocation of each, counted from 1.
  [[nodiscard]] std::vector<long> first_of_each() const;

 private:
  std::vector<std::uint64_t> stacks_;  // of each allocation
};

}  // namespace dapple::test
