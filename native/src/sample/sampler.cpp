// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/sampler.hpp>

#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"
#include "sample/surface_classes.hpp"

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
  return sample_classes(surface, {&all, 1}, options_of_one(options), context);
}

ClassOptions paper_class_options() { return {.two_stages = true, .sample = paper_options()}; }

Samples sample_classes(const Surface& surface, std::span<const SampleClass> classes,
                       const ClassOptions& options, Context* context) {
  return sampled(
      options, context, [&] { return surface_classes(surface, classes, options.sample.cells); },
      [&](const ClassMinimum& found) {
        return to_samples(surface, found.objective, found.minimum, classes.size());
      });
}

}  // namespace dapple
