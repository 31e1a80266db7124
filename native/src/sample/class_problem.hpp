// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/class_options.hpp>
#include <dapple/domain.hpp>

#include "optimize/minimizer.hpp"

namespace dapple {

/// Classes over one domain; one class alone is the plain problem.
struct ClassProblem {
  struct Member {
    std::shared_ptr<const Domain> domain;  ///< with the density of the class
    std::size_t count;
    double radius = 0.0;
    Sites locked = {};
  };
  std::shared_ptr<const Domain> all;  ///< with the density of the union
  std::vector<Member> classes;
};

/// The classes' relative weights in the density of the union: n_c / |S|_phi_c.
[[nodiscard]] std::vector<double> union_weights(const ClassProblem& problem);

/// The class of each site, class by class.
[[nodiscard]] std::vector<std::int32_t> class_of_sites(const ClassProblem& problem);

/// What is minimized for sites of the given classes.
/// \param locked per site; empty: none
[[nodiscard]] Objective make_objective(const ClassProblem& problem,
                                       std::vector<std::int32_t> classes,
                                       const ClassOptions& options, std::vector<bool> locked = {});

/// Where an optimization begins, class by class.
/// \param along see poisson_start()
[[nodiscard]] Sites make_start(const ClassProblem& problem, Start kind, std::uint64_t seed,
                               Context* context, std::size_t* along = nullptr);

/// Make each class even by itself, from its part of the start: the first of two stages.
/// \param sum its evaluations and iterations are added to these
void settle_alone(const ClassProblem& problem, const ClassOptions& options, Sites& sites,
                  Minimum& sum, Context* context);

/// The end of a solution, and what it was measured by.
struct ClassMinimum {
  Objective objective;
  Minimum minimum;
};

/// Minimize from the start; where discs still overlap, ever harder against that.
[[nodiscard]] ClassMinimum solve(Objective objective, const Sites& start,
                                 const OptimizerOptions& options, Context* context);

/// Start and minimize, in one stage or two.
/// \throw ArgumentError for options out of range, or radii for which the area cannot suffice
[[nodiscard]] ClassMinimum solve(const ClassProblem& problem, const ClassOptions& options,
                                 Context* context);

}  // namespace dapple
