// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/classes.hpp>

#include "base/clock.hpp"
#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/surface_classes.hpp"

namespace dapple {

ClassOptions paper_class_options() {
  return {.sample = paper_options(), .union_weight = 1.0, .two_stages = true};
}

Samples sample_classes(const Surface& surface, std::span<const SampleClass> classes,
                       const ClassOptions& options, Context* context) {
  const Clock clock;
  if (context) context->check();
  check_none_locked("sample.locked", options.sample.locked, "classes say themselves which stay");
  Samples samples = with_threads(options.sample.threads, [&] {
    const ClassProblem problem = surface_classes(surface, classes, options.sample.cells);
    const ClassMinimum found = solve(problem, options, context);
    return to_samples(surface, found.objective, found.minimum, classes.size());
  });
  samples.report.seconds = clock.seconds();
  if (context) context->advance(1.0);
  return samples;
}

}  // namespace dapple
