// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/stopwatch.hpp"

#include <utility>

namespace dapple {

Stage Stopwatch::turn_to(Stage stage) {
  const double now = clock_.seconds();
  profile_[stage_] += now - std::exchange(last_, now);
  return std::exchange(stage_, stage);
}

void Stopwatch::credit(Stage stage, double seconds) {
  profile_[stage_] -= seconds;
  profile_[stage] += seconds;
}

Profile Stopwatch::read() {
  turn_to(stage_);
  return profile_;
}

}  // namespace dapple
