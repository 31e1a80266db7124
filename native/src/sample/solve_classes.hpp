// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/minimizer.hpp"
#include "sample/class_problem.hpp"

namespace dapple {

/// Make each class even by itself, from its part of the start: the first of two stages.
/// \param sum its evaluations and iterations are added to these
void settle_alone(const ClassProblem& problem, const ClassOptions& options, Sites& sites,
                  Minimum& sum, Context* context);

/// Sites where no two discs overlap, as far as the surface has room for that.
[[nodiscard]] Sites discs_apart(const Objective& objective, Sites sites, Context* context);

/// Push apart what the last steps have left: to first order they keep discs apart, and a site that
/// is pushed off the density comes back to it.
void end_apart(const Objective& objective, OptimizerOptions options, Minimum& found,
               Context* context);

/// The end of a solution, and what it was measured by.
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
