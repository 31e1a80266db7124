// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/class_problem.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "start/class_start.hpp"

namespace dapple {
namespace {

constexpr double kUnionRadius = 5.0 / 6.0;  // of the repulsion radius, for sites of the union
constexpr double kDiscs = 20.0;             // weight of overlapping discs
constexpr double kPacking = std::numbers::pi / (2.0 * std::numbers::sqrt3);  // densest, of discs

/// How a caller calls what belongs to a class.
std::string member_name(const ClassProblem& problem, std::size_t c, const char* name) {
  return problem.classes.size() == 1 ? name : entry("classes", c) + "." + name;
}

void check_radii(const ClassProblem& problem) {
  double covered = 0.0, most = -1.0;
  std::size_t largest = 0;
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    const ClassProblem::Member& member = problem.classes[c];
    check_at_least(member_name(problem, c, "radius").c_str(), member.radius, 0.0);
    const double area =
        static_cast<double>(member.count) * std::numbers::pi * member.radius * member.radius;
    covered += area;
    if (area > most) largest = c;
    most = std::max(most, area);
  }
  const double room = kPacking * problem.all->area();
  if (covered <= room) return;
  throw ArgumentError("radii need discs of area " + number(covered) + ", and at most " +
                      number(room) + " (the densest packing) fits; most of it, " + number(most) +
                      ", is class " + std::to_string(largest) + ": " +
                      std::to_string(problem.classes[largest].count) + " of radius " +
                      number(problem.classes[largest].radius));
}

void check_counts(const ClassProblem& problem) {
  std::size_t sum = 0;
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    check_count(member_name(problem, c, "count"), problem.classes[c].count);
    sum += problem.classes[c].count;
  }
  check_count("the sum of all counts", sum);
}

void check_locked(const ClassProblem& problem) {
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    const ClassProblem::Member& member = problem.classes[c];
    if (member.locked.size() > member.count)
      throw ArgumentError("locked holds " + std::to_string(member.locked.size()) +
                          " sites of class " + std::to_string(c) + ", whose count is " +
                          std::to_string(member.count) + ": the count includes them");
    check_same_length("locked.barycentric", member.locked.barycentric.size(), "locked.positions",
                      member.locked.size());
    member.domain->check(member.locked);
  }
}

std::vector<std::int32_t> members_of(const std::vector<std::int32_t>& classes, std::size_t c) {
  std::vector<std::int32_t> members;
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k] == static_cast<std::int32_t>(c)) members.push_back(static_cast<std::int32_t>(k));
  return members;
}

}  // namespace

bool any_radius(const ClassProblem& problem) {
  return std::any_of(problem.classes.begin(), problem.classes.end(),
                     [](const auto& member) { return member.radius > 0.0; });
}

bool is_one_free_class(const ClassProblem& problem) {
  if (problem.classes.size() != 1) return false;
  const ClassProblem::Member& only = problem.classes[0];
  return only.locked.size() == 0 && only.radius == 0.0 && problem.all->period() == 0.0;
}

void check(const ClassProblem& problem, const ClassOptions& options) {
  check_options(options);
  check_counts(problem);
  check_radii(problem);
  check_locked(problem);
}

std::vector<bool> locked_sites(const ClassProblem& problem) {
  std::vector<bool> locked;
  bool any = false;
  for (const ClassProblem::Member& member : problem.classes)
    for (std::size_t k = 0; k < member.count; ++k) {
      locked.push_back(k < member.locked.size());
      any = any || locked.back();
    }
  return any ? locked : std::vector<bool>();
}

std::vector<double> union_weights(const ClassProblem& problem) {
  std::vector<double> weights;
  weights.reserve(problem.classes.size());
  for (const ClassProblem::Member& member : problem.classes)
    weights.push_back(static_cast<double>(member.count) / member.domain->capacity() *
                      member.domain->density_unit());
  return weights;
}

std::vector<std::int32_t> class_of_sites(const ClassProblem& problem) {
  std::vector<std::int32_t> classes;
  for (std::size_t c = 0; c < problem.classes.size(); ++c)
    classes.insert(classes.end(), problem.classes[c].count, static_cast<std::int32_t>(c));
  return classes;
}

std::vector<std::vector<std::size_t>> groups_by_count(std::span<const std::size_t> counts) {
  std::vector<std::size_t> order(counts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return counts[a] != counts[b] ? counts[a] < counts[b] : a < b;
  });
  const auto count = [&](std::size_t c) { return static_cast<double>(counts[c]); };
  std::vector<std::vector<std::size_t>> groups;
  for (const std::size_t c : order) {
    if (groups.empty() || count(c) >= kRarer * count(groups.back()[0])) groups.emplace_back();
    groups.back().push_back(c);
  }
  return groups;
}

Objective make_objective(const ClassProblem& problem, std::vector<std::int32_t> classes,
                         const ClassOptions& options, std::vector<bool> locked) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  Objective objective;
  objective.capacity_weight = optimizer.capacity_weight;
  objective.locked = std::move(locked);
  objective.terms.push_back({.domain = problem.all.get(),
                             .repulsion_radius = optimizer.repulsion_radius,
                             .repulsion_weight = optimizer.repulsion_weight,
                             .site_capacity = problem.site_capacity});
  for (const ClassProblem::Member& member : problem.classes)
    objective.homes.push_back(member.domain.get());
  if (any_radius(problem)) {
    for (const std::int32_t c : classes)
      objective.discs.push_back(problem.classes[static_cast<std::size_t>(c)].radius);
    objective.discs_weight = kDiscs / static_cast<double>(std::max<std::size_t>(classes.size(), 1));
  }
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    std::vector<std::int32_t> members = members_of(classes, c);
    if (members.empty() || members.size() == classes.size()) continue;
    objective.terms.push_back({.domain = problem.classes[c].domain.get(),
                               .members = std::move(members),
                               .repulsion_radius = optimizer.repulsion_radius,
                               .repulsion_weight = optimizer.repulsion_weight,
                               .site_capacity = problem.classes[c].site_capacity});
  }
  if (objective.terms.size() > 1) {
    objective.terms[0].weight =
        options.union_weight * static_cast<double>(objective.terms.size() - 1);
    objective.terms[0].repulsion_radius *= kUnionRadius;
  }
  objective.classes = std::move(classes);
  return objective;
}

void leave_out_locked(Objective& objective) {
  std::vector<Term> left;
  for (Term& term : objective.terms)
    if (term.members.empty() || std::any_of(term.members.begin(), term.members.end(), [&](auto k) {
          return !objective.locked[static_cast<std::size_t>(k)];
        }))
      left.push_back(std::move(term));
  objective.terms = std::move(left);
}

Sites make_start(const ClassProblem& problem, Start kind, std::uint64_t seed, Context* context,
                 std::size_t* along) {
  const StageSpan starting(context, Stage::kStart);
  std::size_t count = 0;
  std::vector<Surface> surfaces;
  for (const ClassProblem::Member& member : problem.classes) {
    count += member.count;
    surfaces.push_back(member.domain->start_surface(member.count));
  }
  const Surface all = problem.all->start_surface(count);
  ClassStarts starts{{}, &all, problem.all->period(), seed};
  for (std::size_t c = 0; c < surfaces.size(); ++c) {
    const ClassProblem::Member& member = problem.classes[c];
    starts.classes.push_back({&surfaces[c], member.count, member.radius,
                              member.domain->to_sampling_surface(member.locked)});
  }
  Sites sites =
      kind == Start::kRandom ? random_start(starts) : poisson_start(starts, context, along);
  return starts.period > 0.0 ? problem.all->project(sites.positions, {}, context) : sites;
}

}  // namespace dapple
