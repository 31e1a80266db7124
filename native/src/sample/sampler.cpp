// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/classes.hpp>
#include <dapple/sampler.hpp>

namespace dapple {

SampleOptions paper_options() {
  SampleOptions options;
  options.start = Start::kRandom;
  options.cells = Cells::kEuclidean;
  options.optimizer.method = Method::kLineSearch;
  options.optimizer.repulsion_weight = 0.0;
  options.optimizer.tolerance = 1e-5;
  return options;
}

Samples sample(const Surface& surface, std::size_t count, const SampleOptions& options,
               Context* context) {
  const SampleClass all{.count = count, .locked = options.locked};
  ClassOptions of_class{.sample = options};
  of_class.sample.locked = {};
  return sample_classes(surface, {&all, 1}, of_class, context);
}

}  // namespace dapple
