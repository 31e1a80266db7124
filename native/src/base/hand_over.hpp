// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#ifdef DAPPLE_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace dapple {

/// Declares to ThreadSanitizer what oneTBB guarantees: threads that work for a caller see its
/// earlier writes, and it sees their writes afterward. The distributions' oneTBB is compiled
/// without ThreadSanitizer, which therefore cannot know this. In other builds this does nothing.
class HandOver {
 public:
  HandOver() { release(&given_); }
  ~HandOver() { acquire(&returned_); }
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;

  /// While a thread does a part of the work.
  class Part {
   public:
    explicit Part(HandOver& all) : all_(all) { acquire(&all_.given_); }
    ~Part() { release(&all_.returned_); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    HandOver& all_;
  };

 private:
#ifdef DAPPLE_THREAD_SANITIZER
  static void acquire(char* place) { __tsan_acquire(place); }
  static void release(char* place) { __tsan_release(place); }
#else
  static void acquire(char*) {}
  static void release(char*) {}
#endif
  char given_ = 0, returned_ = 0;  // their addresses name what is handed over
};

}  // namespace dapple
