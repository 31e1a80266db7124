// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/cells.hpp>
#include <dapple/optimizer_options.hpp>

namespace dapple {

struct TrackerOptions {
  double union_weight = 1.0;  ///< mu, of samples of several classes; see ClassOptions

  /// Within one frame no sample slides by half a spacing: after a violent frame evenness is caught
  /// up over the next ones, instead of by a jump.
  OptimizerOptions optimizer = {.max_evaluations = 6, .max_slide = 0.45};
  Cells cells = Cells::kConnected;
  /// Farthest that the surface's shape may move at once, relative to its size, apart from moving as
  /// a whole, scaling and mirroring; a frame on which it moves farther is split into parts. 0:
  /// never.
  double longest_motion = 0.02;
  double pattern_strength =
      0.8;          ///< 0..1: how strongly samples return to the first frame's pattern
  int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

}  // namespace dapple
