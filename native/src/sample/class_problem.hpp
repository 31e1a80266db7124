// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <dapple/sampler.hpp>
#include <functional>
#include <span>

#include "optimize/objective.hpp"

namespace dapple {

/// Classes over one domain; one class alone is the plain problem.
struct ClassProblem {
  struct Member {
    std::shared_ptr<const Domain> domain;  ///< with the density of the class
    std::size_t count;
    double radius = 0.0;
    Sites locked = {};
    double site_capacity = 0.0;  ///< see Term
    /// What is locked among so many sites, as points on lines are: a class of fewer sites has
    /// fewer. None: locked sites are the same for any number.
    std::function<Sites(std::size_t)> locked_among = {};
  };
  std::shared_ptr<const Domain> all;  ///< with the density of the union
  std::vector<Member> classes;
  double site_capacity = 0.0;  ///< of the union; see Term
};

[[nodiscard]] bool any_radius(const ClassProblem& problem);

/// Whether there is one class alone on a surface or in the plane, without discs, whose sites may go
/// anywhere.
[[nodiscard]] bool is_one_free_class(const ClassProblem& problem);

/// \throw ArgumentError for options out of range, or radii whose discs exceed the densest packing
void check(const ClassProblem& problem, const ClassOptions& options);

/// Per site, class by class, whether it is locked; empty: none is.
[[nodiscard]] std::vector<bool> locked_sites(const ClassProblem& problem);

/// The classes' relative weights in the density of the union: n_c / |S|_phi_c.
[[nodiscard]] std::vector<double> union_weights(const ClassProblem& problem);

/// The class of each site, class by class.
[[nodiscard]] std::vector<std::int32_t> class_of_sites(const ClassProblem& problem);

/// Times as many samples as another class has: the rarer one comes first.
inline constexpr double kRarer = 3.0;

/// Classes by how rare they are. A group begins with a class that has several times as many samples
/// as the rarest of the group before; an empty class is one of its own.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_by_count(
    std::span<const std::size_t> counts);

/// The minimized function for sites of the given classes.
/// \param locked per site; empty: none
[[nodiscard]] Objective make_objective(const ClassProblem& problem,
                                       std::vector<std::int32_t> classes,
                                       const ClassOptions& options, std::vector<bool> locked = {});

/// Without the terms of classes whose sites are all locked: nothing that moves is of them. That of
/// all stays.
void leave_out_locked(Objective& objective);

/// The initial positions, class by class.
/// \param along see poisson_start()
[[nodiscard]] Sites make_start(const ClassProblem& problem, Start kind, std::uint64_t seed,
                               Context* context, std::size_t* along = nullptr);

}  // namespace dapple
