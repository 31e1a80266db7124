// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/class_options.hpp>

namespace dapple {

struct TrackerOptions {
  double union_weight = 1.0;
  /// Within one frame no sample slides by half a spacing, which would be a jump.
  OptimizerOptions optimizer = {.max_evaluations = 6, .max_slide = 0.45};
  Cells cells = Cells::kConnected;
  double longest_motion = 0.02;
  double pattern_strength = 0.8;
  int threads = 0;
};

inline constexpr std::tuple kTrackerOptions = {
    union_weight_option(&TrackerOptions::union_weight),
    Group{&TrackerOptions::optimizer},
    Option{"pattern_strength",
           &TrackerOptions::pattern_strength,
           {0.0, 1.0},
           "",
           Level::kExpert,
           "How strongly samples return to the first frame's pattern where a deformation has gone; "
           "0 lets it drift."},
    Option{"longest_motion",
           &TrackerOptions::longest_motion,
           {},
           "sizes of the surface",
           Level::kExpert,
           "Farthest that the surface's shape may move at once, apart from moving as a whole, "
           "scaling and mirroring: a frame on which it moves farther is split; 0 never splits."},
    cells_option(&TrackerOptions::cells),
    threads_option(&TrackerOptions::threads)};

constexpr const auto& options_of(const TrackerOptions&) { return kTrackerOptions; }

}  // namespace dapple
