// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/sampler.hpp>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"
#include "sample/surface_classes.hpp"
#include "sample/timed_call.hpp"

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

ClassOptions paper_class_options() { return {.two_stages = true, .sample = paper_options()}; }

Samples sample_classes(const Surface& surface, std::span<const SampleClass> classes,
                       const ClassOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check_none_locked("sample.locked", options.sample.locked, "classes say themselves which stay");
  Samples samples = with_threads(options.sample.threads, [&] {
    const ClassProblem problem = surface_classes(surface, classes, options.sample.cells);
    const ClassMinimum found = solve(problem, options, call.context());
    return in_stage(call.context(), Stage::kReporting, [&] {
      return to_samples(surface, found.objective, found.minimum, classes.size());
    });
  });
  call.write(samples.report);
  if (context) context->advance(1.0);
  return samples;
}

}  // namespace dapple
