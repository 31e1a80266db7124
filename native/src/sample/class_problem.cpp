// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/class_problem.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "optimize/forecast.hpp"
#include "sample/rebalance.hpp"
#include "start/class_start.hpp"
#include "surface/islands.hpp"

namespace dapple {
namespace {

constexpr double kUnionRadius = 5.0 / 6.0;  // of the repulsion radius, between sites of any class
constexpr double kDiscs = 20.0;             // weight of overlapping discs in the first round ...
constexpr double kHarder = 10.0;            // ... and by how much it grows
constexpr int kRounds = 4;
constexpr double kStarting = 3.0;  // a start takes as long as so many evaluations
constexpr double kThin = 0.1;      // of the tolerance, where most samples are on thin parts ...
constexpr double kEven = 0.005;    // ... and the capacities vary by more, for at most ...
constexpr int kMore = 15;          // ... so many evaluations more
constexpr int kSettling = 2;       // times that the numbers of neighborhoods are looked at
constexpr double kAlone = 0.35;    // of the progress after the start: every class is even by itself
constexpr double kRound = 0.4;  // of the progress that is left: nobody knows how many there will be
constexpr double kOverlap = 1e-3;  // of the wanted distance: less is good enough
constexpr double kPacking = std::numbers::pi / (2.0 * std::numbers::sqrt3);  // densest, of discs

bool any_radius(const ClassProblem& problem) {
  return std::any_of(problem.classes.begin(), problem.classes.end(),
                     [](const auto& member) { return member.radius > 0.0; });
}

void check_radii(const ClassProblem& problem) {
  double covered = 0.0, most = -1.0;
  std::size_t largest = 0;
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    const ClassProblem::Member& member = problem.classes[c];
    check_at_least("radius", member.radius, 0.0);
    const double area =
        static_cast<double>(member.count) * std::numbers::pi * member.radius * member.radius;
    covered += area;
    if (area > most) largest = c;
    most = std::max(most, area);
  }
  const double room = kPacking * problem.all->area();
  if (covered <= room) return;
  throw ArgumentError("radii ask for discs of area " + number(covered) + ", and at most " +
                      number(room) + " (the densest packing) fits; most of it, " + number(most) +
                      ", is class " + std::to_string(largest) + ": " +
                      std::to_string(problem.classes[largest].count) + " of radius " +
                      number(problem.classes[largest].radius));
}

void check_counts(const ClassProblem& problem) {
  std::size_t sum = 0;
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    check_count(problem.classes.size() == 1 ? "count" : entry("classes", c) + ".count",
                problem.classes[c].count);
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

std::vector<std::int32_t> members_of(const std::vector<std::int32_t>& classes, std::size_t c) {
  std::vector<std::int32_t> members;
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k] == static_cast<std::int32_t>(c)) members.push_back(static_cast<std::int32_t>(k));
  return members;
}

}  // namespace

std::vector<double> union_weights(const ClassProblem& problem) {
  std::vector<double> weights;
  weights.reserve(problem.classes.size());
  for (const ClassProblem::Member& member : problem.classes)
    weights.push_back(static_cast<double>(member.count) / member.domain->mass() *
                      member.domain->density_unit());
  return weights;
}

std::vector<std::int32_t> class_of_sites(const ClassProblem& problem) {
  std::vector<std::int32_t> classes;
  for (std::size_t c = 0; c < problem.classes.size(); ++c)
    classes.insert(classes.end(), problem.classes[c].count, static_cast<std::int32_t>(c));
  return classes;
}

Objective make_objective(const ClassProblem& problem, std::vector<std::int32_t> classes,
                         const ClassOptions& options, std::vector<bool> locked) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  Objective objective;
  objective.capacity_weight = optimizer.capacity_weight;
  objective.locked = std::move(locked);
  objective.terms.push_back({.domain = problem.all.get(),
                             .repulsion_radius = optimizer.repulsion_radius,
                             .repulsion_weight = optimizer.repulsion_weight});
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
                               .repulsion_weight = optimizer.repulsion_weight});
  }
  if (objective.terms.size() > 1) {
    objective.terms[0].weight =
        options.union_weight * static_cast<double>(objective.terms.size() - 1);
    objective.terms[0].repulsion_radius *= kUnionRadius;
  }
  objective.classes = std::move(classes);
  return objective;
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

void settle_alone(const ClassProblem& problem, const ClassOptions& options, Sites& sites,
                  Minimum& sum, Context* context) {
  std::int32_t first = 0;
  const auto done = [&] { return static_cast<double>(first) / static_cast<double>(sites.size()); };
  for (const ClassProblem::Member& member : problem.classes) {
    std::vector<std::int32_t> members(member.count);
    std::iota(members.begin(), members.end(), first);
    const double from = members.empty() ? 0.0 : done();
    first += static_cast<std::int32_t>(member.count);
    if (members.empty()) continue;
    Stretch step(context, from, done());
    const ClassProblem alone{member.domain, {member}};
    const Minimum found =
        minimize(make_objective(alone, class_of_sites(alone), options, locked_sites(alone)),
                 select(sites, members), options.sample.optimizer, step.context());
    put(sites, members, found.state.sites);
    sum.evaluations += found.evaluations;
    sum.iterations += found.iterations;
  }
}

/// The same number of sites, as many in each neighborhood as its share of the density asks for.
/// Those that stay keep their places in the order.
Sites evened(const Domain& domain, const Sites& sites, std::uint64_t seed, Context* context,
             int& evaluations) {
  const Rebalanced found = rebalance(domain, sites, sites.size(), seed, context);
  evaluations += found.evaluations;
  std::vector<bool> stays(sites.size(), false);
  for (const std::size_t k : found.stay) stays[k] = true;
  std::vector<std::int32_t> gone;
  for (std::size_t k = 0; k < stays.size(); ++k)
    if (!stays[k]) gone.push_back(static_cast<std::int32_t>(k));
  Sites result = sites;
  put(result, gone, found.fresh);
  return result;
}

/// Darts keep apart, but how many are here or there is left to chance. Where there are gaps without
/// density no step takes one across, and few get around them. Discs and locked sites stay as they
/// were thrown.
int settle_islands(const ClassProblem& problem, std::uint64_t seed, Sites& sites,
                   Context* context) {
  int evaluations = 0;
  std::int32_t first = 0;
  for (const ClassProblem::Member& member : problem.classes) {
    std::vector<std::int32_t> members(member.count);
    std::iota(members.begin(), members.end(), first);
    first += static_cast<std::int32_t>(member.count);
    if (any_radius(problem) || members.empty() || member.locked.size() > 0 ||
        !Islands(member.domain->sampling_surface(member.count)).has_gaps())
      continue;
    Sites own = select(sites, members);
    for (int round = 0; round < kSettling; ++round)
      own = evened(*member.domain, own, seed, context, evaluations);
    put(sites, members, own);
  }
  return evaluations;
}

ClassMinimum solve(Objective objective, const Sites& start, const OptimizerOptions& options,
                   Context* context) {
  double done = objective.discs.empty() ? 1.0 : kRound;
  Stretch first(context, 0.0, done);
  Minimum found = minimize(objective, start, options, first.context());
  for (int round = 1; round < kRounds && !objective.discs.empty(); ++round) {
    const ClosePair* worst = worst_pair(found.state.discs);
    if (!worst || worst->overlap <= kOverlap) break;
    objective.discs_weight *= kHarder;
    const double before = std::exchange(done, done + kRound * (1.0 - done));
    Stretch harder(context, before, done);
    Minimum next = minimize(objective, found.state.sites, options, harder.context());
    next.evaluations += found.evaluations;
    next.iterations += found.iterations;
    found = std::move(next);
  }
  return {std::move(objective), std::move(found)};
}

/// The share of the time that the start takes; several classes are evaluated twice.
double share_of_start(const ClassProblem& problem, const ClassOptions& options) {
  if (options.sample.start == Start::kRandom) return 0.0;
  const double evaluations = expected_evaluations(options.sample.optimizer);
  return kStarting / (kStarting + evaluations * (problem.classes.size() > 1 ? 2.0 : 1.0));
}

/// On thin parts the start is nearly even: the first steps gain little, but more follow.
void go_on_along(ClassMinimum& found, OptimizerOptions options, Context* context) {
  options.max_evaluations = std::min(kMore, options.max_evaluations - found.minimum.evaluations);
  if (options.max_evaluations < 1 ||
      capacity_variation(found.objective, found.minimum.state) <= kEven) {
    if (context) context->advance(1.0);
    return;
  }
  options.tolerance *= kThin;
  Minimum next = minimize(found.objective, found.minimum.state.sites, options, context);
  next.evaluations += found.minimum.evaluations;
  next.iterations += found.minimum.iterations;
  next.converged = next.converged || found.minimum.converged;
  found.minimum = std::move(next);
}

ClassMinimum solve(const ClassProblem& problem, const ClassOptions& options, Context* context) {
  check(problem, options);
  std::size_t along = 0;
  const double started = share_of_start(problem, options);
  Stretch starting(context, 0.0, started);
  Sites start =
      make_start(problem, options.sample.start, options.sample.seed, starting.context(), &along);
  if (context) context->advance(started);
  const bool stages = options.two_stages && problem.classes.size() > 1;
  const double together = stages ? started + kAlone * (1.0 - started) : started;
  Stretch alone(context, started, together);
  const bool thin = 2 * along > start.size();
  const double first = thin ? together + kRound * (1.0 - together) : 1.0;
  Stretch finishing(context, together, first), going_on(context, first, 1.0);
  Minimum before;
  if (options.sample.start == Start::kPoisson && problem.all->period() == 0.0)
    before.evaluations += settle_islands(problem, options.sample.seed, start, nullptr);
  if (stages) settle_alone(problem, options, start, before, alone.context());
  ClassMinimum found =
      solve(make_objective(problem, class_of_sites(problem), options, locked_sites(problem)), start,
            options.sample.optimizer, finishing.context());
  if (thin) go_on_along(found, options.sample.optimizer, going_on.context());
  found.minimum.evaluations += before.evaluations;
  found.minimum.iterations += before.iterations;
  return found;
}

}  // namespace dapple
