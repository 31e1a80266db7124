// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <string>

namespace dapple::python {

/// \throw ArgumentError for another name
inline Method method_named(const std::string& name) {
  if (name == "trust_region") return Method::kTrustRegion;
  if (name == "line_search") return Method::kLineSearch;
  throw ArgumentError("method is '" + name + "': it must be 'trust_region' or 'line_search'");
}

inline OptimizerOptions optimizer_options(double capacity_weight, double gap_weight,
                                          double tolerance, int max_evaluations,
                                          const std::string& method) {
  OptimizerOptions options;
  options.method = method_named(method);
  options.capacity_weight = capacity_weight;
  options.gap_weight = gap_weight;
  options.tolerance = tolerance;
  options.max_evaluations = max_evaluations;
  return options;
}

/// \throw ArgumentError for another name
inline Start start_named(const std::string& name) {
  if (name == "poisson") return Start::kPoisson;
  if (name == "random") return Start::kRandom;
  throw ArgumentError("start is '" + name + "': it must be 'poisson' or 'random'");
}

}  // namespace dapple::python
