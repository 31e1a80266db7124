// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/laps.hpp"

namespace dapple {

SharedLoop::~SharedLoop() {
  if (in_all_ > 0.0) stopwatch_->credit(other_, clock_.seconds() * (in_other_ / in_all_));
}

void SharedLoop::add(double in_other, double in_all) {
  const std::lock_guard lock(adding_);
  in_other_ += in_other;
  in_all_ += in_all;
}

}  // namespace dapple
