// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/errors.hpp>
#include <dapple/sampler.hpp>
#include <string>

#include "bindings.hpp"

namespace dapple::python {

/// \throw ArgumentError for another name
inline Method method_named(const std::string& name) {
  if (name == "trust_region") return Method::kTrustRegion;
  if (name == "line_search") return Method::kLineSearch;
  throw ArgumentError("method is '" + name + "': it must be 'trust_region' or 'line_search'");
}

inline OptimizerOptions optimizer_options(double capacity_weight, double repulsion_weight,
                                          double tolerance, int max_evaluations,
                                          const std::string& method) {
  OptimizerOptions options;
  options.method = method_named(method);
  options.capacity_weight = capacity_weight;
  options.repulsion_weight = repulsion_weight;
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

/// The options that every sampler takes, on a surface or in the plane.
inline SampleOptions sample_options(std::uint64_t seed, double capacity_weight,
                                    double repulsion_weight, double tolerance, int max_evaluations,
                                    const std::string& method, const std::string& start,
                                    const std::string& cells, int threads) {
  SampleOptions options;
  options.seed = seed;
  options.start = start_named(start);
  options.cells = cells_named(cells);
  options.optimizer =
      optimizer_options(capacity_weight, repulsion_weight, tolerance, max_evaluations, method);
  options.threads = threads;
  return options;
}

}  // namespace dapple::python
