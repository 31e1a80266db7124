// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/minimizer.hpp"
#include "sample/class_problem.hpp"

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

}  // namespace dapple
