// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "base/parallel.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "sample/solve_classes.hpp"
#include "sample/timed_call.hpp"

namespace dapple {

/// The options for a single class, whose locked sites the class holds.
[[nodiscard]] inline ClassOptions options_of_one(SampleOptions options) {
  options.locked = {};
  return {.sample = std::move(options)};
}

/// Solve what `make_problem()` returns and pass the solution to `make_samples`, on any domain. The
/// call is timed, and the context is watched.
/// \throw ArgumentError for options out of range; Cancelled
template <class MakeProblem, class MakeSamples>
[[nodiscard]] auto sampled(const ClassOptions& options, Context* context,
                           const MakeProblem& make_problem, const MakeSamples& make_samples) {
  TimedCall call(context);
  if (context) context->check();
  check_none_locked("sample.locked", options.sample.locked, "classes say themselves which stay");
  auto samples = with_threads(options.sample.threads, [&] {
    const ClassProblem problem = make_problem();  // the solution refers to its domains
    const ClassMinimum found = solve(problem, options, call.context());
    return in_stage(call.context(), Stage::kReporting, [&] { return make_samples(found); });
  });
  call.write(samples.report);
  if (context) context->advance(1.0);
  return samples;
}

}  // namespace dapple
