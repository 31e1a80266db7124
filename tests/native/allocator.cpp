// SPDX-License-Identifier: GPL-3.0-or-later
#include "allocator.hpp"

#include <dlfcn.h>
#include <execinfo.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <set>
#include <span>

// The linker replaces calls of the second function of each pair by calls of the first, see
// CMakeLists.txt.
extern "C" {
void* __wrap_malloc(std::size_t size);
void* __real_malloc(std::size_t size);
void __wrap_free(void* memory);
void __real_free(void* memory);
}

namespace {

constexpr long kNone = std::numeric_limits<long>::max();
constexpr int kFrames = 8;  // return addresses that identify a call
constexpr int kDeep = 40;   // return addresses that are searched for a function
using Stack = std::array<void*, kDeep>;

std::atomic<long> made = 0, live = 0;
std::atomic<long> first_missing = kNone, end_missing = kNone;
std::span<std::uint64_t> stacks;
long stacks_begin = 0;
Stack missed{};  // the call stack of the first allocation that failed
const void* spared_library = nullptr;
std::span<const void* const> not_spared;

std::uint64_t stack_here() {
  std::array<void*, kFrames> frames{};
  const int count = backtrace(frames.data(), kFrames);
  std::uint64_t hash = 0;
  for (int k = 0; k < count; ++k)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(frames[static_cast<std::size_t>(k)])) *
           0x9e3779b97f4a7c15u;
  return hash;
}

bool is_in(const Stack& stack, const void* function) {
  constexpr std::uintptr_t kLong = 512;  // most bytes of a function that only calls others
  const auto begin = reinterpret_cast<std::uintptr_t>(function);
  return std::any_of(stack.begin(), stack.end(), [&](const void* frame) {
    return reinterpret_cast<std::uintptr_t>(frame) - begin < kLong;
  });
}

/// The address at which the file that contains the function is loaded.
const void* library_of(const void* function) {
  Dl_info found{};
  return function && dladdr(function, &found) != 0 ? found.dli_fbase : nullptr;
}

bool is_spared(const Stack& stack) {
  const auto is_there = [](const void* frame) { return library_of(frame) == spared_library; };
  const auto is_exception = [&](const void* function) { return is_in(stack, function); };
  return spared_library && std::any_of(stack.begin(), stack.end(), is_there) &&
         std::none_of(not_spared.begin(), not_spared.end(), is_exception);
}

bool is_missing(long number) {
  if (number < first_missing || number >= end_missing) return false;
  Stack stack{};
  backtrace(stack.data(), kDeep);
  if (number == first_missing) missed = stack;
  return !is_spared(stack);
}

/// \return whether this allocation may succeed
bool granted() {
  const long number = ++made;
  const long place = number - stacks_begin - 1;
  if (place >= 0 && place < static_cast<long>(stacks.size()))
    stacks[static_cast<std::size_t>(place)] = stack_here();
  if (is_missing(number)) return false;
  ++live;
  return true;
}

void* counted(std::size_t size, std::size_t alignment) {
  if (!granted()) throw std::bad_alloc();
  const std::size_t whole =
      (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
  if (void* memory = std::aligned_alloc(alignment, whole)) return memory;
  throw std::bad_alloc();
}

void forget(void* memory) {
  if (memory) --live;
  __real_free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { forget(memory); }
void operator delete(void* memory, std::size_t) noexcept { forget(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { forget(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { forget(memory); }

void* __wrap_malloc(std::size_t size) { return granted() ? __real_malloc(size) : nullptr; }
void __wrap_free(void* memory) { forget(memory); }

namespace dapple::test {

long allocations() { return made; }

long live_allocations() { return live; }

OutOfMemory::OutOfMemory(long number, long count) {
  (void)stack_here();  // the first call loads a library
  missed = {};
  first_missing = made + number;
  end_missing = count < kNone - first_missing ? first_missing + count : kNone;
}

OutOfMemory::~OutOfMemory() { first_missing = end_missing = kNone; }

bool was_missing_in(const void* function) { return is_in(missed, function); }

void spare_library_of(const void* function, std::span<const void* const> except) {
  spared_library = library_of(function);
  not_spared = except;
}

CallSites::CallSites(long most) : stacks_(static_cast<std::size_t>(most)) {
  (void)stack_here();  // the first call loads a library
  stacks_begin = made;
  stacks = stacks_;
}

CallSites::~CallSites() { stacks = {}; }

std::vector<long> CallSites::first_of_each() const {
  stacks = {};
  std::set<std::uint64_t> seen;
  std::vector<long> first;
  for (std::size_t k = 0; k < stacks_.size(); ++k)
    if (stacks_[k] != 0 && seen.insert(stacks_[k]).second)
      first.push_back(static_cast<long>(k) + 1);
  return first;
}

}  // namespace dapple::test
