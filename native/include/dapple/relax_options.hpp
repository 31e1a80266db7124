// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/class_options.hpp>
#include <optional>
#include <vector>

namespace dapple {

struct RelaxOptions {
  std::uint64_t seed = 0;
  OptimizerOptions optimizer = {};
  /// Number of samples wanted; the difference comes and goes where something has changed, and all
  /// around where it is large. None: chosen so that new samples match their neighbors' capacity.
  std::optional<std::size_t> count = {};
  /// Indices of samples that stay where they are. New ones may come between them.
  std::vector<std::int32_t> locked = {};
  /// What each class is to be; `locked` says which samples stay. None: they are of one class.
  std::vector<SampleClass> classes = {};
  /// Whether there become as many samples of a class as fit those around, not as many as it counts.
  bool free_counts = false;
  double union_weight = 1.0;
  int threads = 0;
};

inline constexpr std::tuple kRelaxOptions = {
    seed_option(&RelaxOptions::seed), union_weight_option(&RelaxOptions::union_weight),
    Option{"free_counts",
           &RelaxOptions::free_counts,
           {},
           "",
           Level::kExpert,
           "Classes get as many samples as fit those "
           "around, not as many as they count."},
    Group{&RelaxOptions::optimizer}, threads_option(&RelaxOptions::threads)};

constexpr const auto& options_of(const RelaxOptions&) { return kRelaxOptions; }

}  // namespace dapple
