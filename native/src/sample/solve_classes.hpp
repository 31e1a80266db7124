// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "optimize/minimizer.hpp"
#include "sample/class_problem.hpp"
#include "sample/timed_call.hpp"

namespace dapple {

/// Optimize each class alone, from its part of the start: the first of two stages.
/// \param sum its evaluations and iterations are added to these
void settle_alone(const ClassProblem& problem, const ClassOptions& options, Sites& sites,
                  Minimum& sum, Context* context);

/// Sites without overlapping discs, as far as the surface has room.
[[nodiscard]] Sites discs_apart(const Objective& objective, Sites sites, Context* context);

/// Separate discs that still overlap after the last steps, which keep them apart only to first
/// order; a site pushed off the density is moved back to it.
void end_apart(const Objective& objective, OptimizerOptions options, Minimum& found,
               Context* context);

/// The result of a solution, and its objective.
struct ClassMinimum {
  Objective objective;
  Minimum minimum;
};

/// Minimize from the start. Where discs then overlap they are put apart, and no further step brings
/// two of them nearer than they may be.
[[nodiscard]] ClassMinimum solve(Objective objective, const Sites& start,
                                 const OptimizerOptions& options, Context* context);

/// Start and minimize: all classes at once, or the rare ones first where some are far rarer than
/// others; in two stages where that is asked for.
/// \throw ArgumentError for options out of range, or radii whose discs exceed the densest packing
[[nodiscard]] ClassMinimum solve(const ClassProblem& problem, const ClassOptions& options,
                                 Context* context);

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
