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

constexpr std::array<Choice<Start>, 2> choices_of(Start) {
  return {{{"poisson", Start::kPoisson}, {"random", Start::kRandom}}};
}

struct SampleOptions {
  std::uint64_t seed = 0;
  Start start = Start::kPoisson;
  OptimizerOptions optimizer = {};
  Cells cells = Cells::kConnected;
  /// Sites that stay where they are and take part, with barycentric coordinates; they come first,
  /// and the count includes them.
  Sites locked = {};
  int threads = 0;
};

inline constexpr std::tuple kSampleOptions = {
    seed_option(&SampleOptions::seed), Group{&SampleOptions::optimizer},
    Option{"start",
           &SampleOptions::start,
           {},
           "",
           Level::kExpert,
           "Where the optimization begins: with a Poisson-disk set, or with white noise, as in the "
           "paper."},
    cells_option(&SampleOptions::cells), threads_option(&SampleOptions::threads)};

constexpr const auto& options_of(const SampleOptions&) { return kSampleOptions; }

/// The paper's own way: white noise, plain L-BFGS, no repulsion, Euclidean cells.
[[nodiscard]] SampleOptions paper_options();

}  // namespace dapple
