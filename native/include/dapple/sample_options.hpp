// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/cells.hpp>
#include <dapple/optimizer_options.hpp>

namespace dapple {

/// Where the optimization begins.
enum class Start {
  kPoisson,  ///< Poisson-disk set: fewer iterations, larger gaps
  kRandom,   ///< white noise, as in the paper
};

struct SampleOptions {
  std::uint64_t seed = 0;
  Start start = Start::kPoisson;
  OptimizerOptions optimizer = {};
  Cells cells = Cells::kConnected;
  /// Sites that stay where they are and take part, with barycentric coordinates; they come first,
  /// and the count includes them.
  Sites locked = {};
  int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

/// The paper's own way: white noise, plain L-BFGS, no repulsion, Euclidean cells.
[[nodiscard]] SampleOptions paper_options();

}  // namespace dapple
