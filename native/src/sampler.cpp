// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/errors.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/sampler.hpp>

#include "clock.hpp"
#include "outcome.hpp"
#include "parallel.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

Sites make_start(const Surface& surface, std::size_t count, const SampleOptions& options,
                 const Context* context) {
  return options.start == Start::kRandom ? random_start(surface, count, options.seed)
                                         : poisson_start(surface, count, options.seed, context);
}

}  // namespace

SampleOptions paper_options() {
  SampleOptions options;
  options.start = Start::kRandom;
  options.cells = Cells::kEuclidean;
  options.optimizer.method = Method::kLineSearch;
  options.optimizer.gap_weight = 0.0;
  options.optimizer.tolerance = 1e-5;
  return options;
}

Samples sample(const Surface& surface, std::size_t count, const SampleOptions& options,
               Context* context) {
  const Clock clock;
  if (context) context->check();
  check_at_least("threads", options.threads, 0);
  Samples samples = with_threads(options.threads, [&] {
    const Sites start = make_start(surface, count, options, context);
    return to_samples(surface, optimize(SurfaceDomain(surface, options.cells), start,
                                        options.optimizer, context));
  });
  samples.report.seconds = clock.seconds();
  if (context) context->advance(1.0);
  return samples;
}

}  // namespace dapple
