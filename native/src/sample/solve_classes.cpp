// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/solve_classes.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <numeric>
#include <utility>

#include "base/progress.hpp"
#include "optimize/discs.hpp"
#include "optimize/forecast.hpp"
#include "optimize/mending.hpp"
#include "rebalance/rebalance.hpp"
#include "rebalance/trade_singles.hpp"
#include "sample/outcome.hpp"
#include "sample/subdivided_start.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kHarder = 10.0;  // factor by which the weight of discs that still overlap grows
constexpr int kRounds = 4;
constexpr int kPushes = 20;  // times that overlapping discs are pushed apart along the surface
constexpr double kOverlap = 1e-3;       // of the wanted distance: smaller overlaps are accepted
constexpr double kStarting = 3.0;       // a start takes as long as this many evaluations
constexpr double kSubdividing = 12.0;   // one for a lattice
constexpr double kThin = 0.1;           // of the tolerance, if most samples are on thin parts
constexpr double kEven = 0.005;         // and the capacity variation is larger than this
constexpr int kMore = 15;               // most additional evaluations
constexpr std::size_t kFew = 50;        // fewer sites do not suffice to recognize a shell
constexpr std::size_t kLookedAt = 500;  // sites that are examined
constexpr double kShell = 0.5;          // share of them that have the other side nearby
constexpr std::size_t kNearest = 6;     // nearest sites in space, including the site itself
constexpr double kOtherSide = -0.5;     // cosine between normals
constexpr double kAlone =
    0.35;  // share of the progress after the start when each class is even on its own
constexpr double kRound = 0.4;      // share of the remaining progress, as their number is unknown
constexpr double kRough = 5e-4;     // tolerance before all classes move together
constexpr double kJoint = 1.5;      // times the tolerance, if several classes begin together
constexpr double kPolish = 2.0;     // if classes are nearly even when combined
constexpr double kInTurn = 0.6;     // of the progress after the start
constexpr double kNearly = 0.9;     // of the progress, before sites are moved
constexpr double kUseful = 20.0;    // the least weight of capacities that are to be equal
constexpr double kMoving = 0.2;     // of a round
constexpr double kPerStep = 1.8;    // evaluations, where it is worthwhile to continue
constexpr double kOver = 0.4;       // of the progress after the steps: the numbers are right
constexpr double kEnding = 0.6;     // and the cells are even
constexpr int kMoved = 5;           // evaluations that a round takes at least
constexpr int kMoves = 6;           // times that sites are moved after the steps
constexpr std::size_t kFewest = 3;  // sites to move for which another minimization is worthwhile
// While the capacity variation is larger, apart from what whole numbers cause.
constexpr double kUneven = 0.012;
constexpr double kTrading = 0.02;  // likewise, for trades of single sites
// Sites are moved early if the variation is larger than this after a few steps, the last of which
// decreased the energy by less than so many tolerances. Smooth bodies are below it then.
constexpr double kFarFromEven = 0.045;
constexpr int kFirstSteps = 3;
constexpr std::size_t kMany = 500;  // sites; of fewer, the variation says little after few steps
constexpr double kSlow = 100.0;

std::vector<std::int32_t> numbers_from(std::int32_t first, std::size_t count) {
  std::vector<std::int32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

/// The evaluations that are left, at least one because positions are needed.
int evaluations_left(const OptimizerOptions& options, const Minimum& sum) {
  return std::max(options.max_evaluations - sum.evaluations, 1);
}

}  // namespace

Sites discs_apart(const Objective& objective, Sites sites, Context* context) {
  Evaluation state;
  state.sites = std::move(sites);
  for (int push = 0; push < kPushes; ++push) {
    update_normals(state, objective);
    const Discs discs = discs_of(objective, state);
    const Repulsion close = evaluate_disc_repulsion(discs, 1.0);
    if (close.pairs.empty()) break;
    Vectors moves(state.sites.size(), Vec3::Zero());
    keep_discs_apart(discs, objective.locked, moves);
    objective.move(moves, state.sites, context);
  }
  return std::move(state.sites);
}

void end_apart(const Objective& objective, OptimizerOptions options, Minimum& found,
               Context* context) {
  if (found.state.discs.pairs.empty()) return;
  options.max_evaluations = 1;
  Minimum apart =
      minimize(objective, discs_apart(objective, found.state.sites, context), options, nullptr);
  found.evaluations += apart.evaluations;
  if (worst_overlap(apart.state.discs) < worst_overlap(found.state.discs))
    found.state = std::move(apart.state);
}

void settle_alone(const ClassProblem& problem, const ClassOptions& options, Sites& sites,
                  Minimum& sum, Context* context) {
  std::int32_t first = 0;
  const auto done = [&] { return static_cast<double>(first) / static_cast<double>(sites.size()); };
  for (const ClassProblem::Member& member : problem.classes) {
    const std::vector<std::int32_t> members = numbers_from(first, member.count);
    const double from = members.empty() ? 0.0 : done();
    first += static_cast<std::int32_t>(member.count);
    if (members.empty()) continue;
    Stretch step(context, from, done());
    const ClassProblem alone{member.domain, {member}};
    const Minimum found =
        minimize(make_objective(alone, class_of_sites(alone), options, locked_sites(alone)),
                 select(sites, members), options.sample.optimizer, step.context());
    put(sites, members, found.state.sites);
    sum.count(found);
  }
}

namespace {

struct Evened {
  Sites sites;
  std::size_t moved = 0;
  int evaluations = 0;
};

/// New sites instead of those that went. Sites that stay keep their index.
Evened replaced(const Sites& sites, const Rebalanced& found) {
  std::vector<bool> stays(sites.size(), false);
  for (const std::size_t k : found.stay) stays[k] = true;
  std::vector<std::int32_t> gone;
  for (std::size_t k = 0; k < stays.size(); ++k)
    if (!stays[k]) gone.push_back(static_cast<std::int32_t>(k));
  Evened result{sites, gone.size(), found.evaluations};
  put(result.sites, gone, found.fresh);
  return result;
}

/// Move sites between neighborhoods so that each has its share of the density. The number of sites
/// does not change.
Evened evened(const Domain& domain, const Sites& sites, std::uint64_t seed, Context* context) {
  return replaced(sites, rebalance(domain, sites, sites.size(), seed, context));
}

/// Trade single sites between places that hold one too few and places that hold one too many.
Evened traded(const Domain& domain, const Evaluation& state, std::uint64_t seed) {
  const Exchange trades = find_trades(state.diagram());
  if (std::all_of(trades.changes.begin(), trades.changes.end(), [](auto c) { return c == 0; }))
    return {state.sites};
  return replaced(state.sites, move_between(domain, state.sites, state.diagram(), trades, seed));
}

/// Whether many sites have sites of the other side of a sheet as close as their neighbors, and the
/// two sides are connected over a rim.
bool is_thin_shell(const Domain& domain, const Surface& surface, const Sites& sites) {
  if (sites.size() < kFew) return false;
  const OrderedSurface& ordered = surface.ordered();
  const Sites there = domain.to_sampling_surface(sites);
  const auto face = [&](std::size_t k) { return ordered.ordered_face(there.faces[k]); };
  const auto is_beyond = [&](std::size_t k, std::size_t other) {
    return domain.normal(sites.faces[k]).dot(domain.normal(sites.faces[other])) < kOtherSide &&
           ordered.component(face(k)) == ordered.component(face(other));
  };
  const Neighbors tree(sites.positions);
  std::vector<Neighbor> near;
  std::size_t looked_at = 0, close = 0;
  for (std::size_t k = 0; k < sites.size();
       k += std::max<std::size_t>(sites.size() / kLookedAt, 1), ++looked_at) {
    tree.nearest(sites.positions[k], kNearest, near);
    if (std::any_of(near.begin(), near.end(), [&](const Neighbor& other) {
          return is_beyond(k, static_cast<std::size_t>(other.index));
        }))
      ++close;
  }
  return static_cast<double>(close) > kShell * static_cast<double>(looked_at);
}

/// Correct the numbers of sites on islands of the density and on thin shells. Darts keep their
/// distance, but their local number is random; no step of the optimization crosses a gap without
/// density, and few sites move around gaps or the rim of a shell. Classes with locked sites are not
/// changed.
int settle_islands(const ClassProblem& problem, std::uint64_t seed, Sites& sites,
                   Context* context) {
  int evaluations = 0;
  if (problem.all->period() > 0.0) return evaluations;
  std::int32_t first = 0;
  for (const ClassProblem::Member& member : problem.classes) {
    const std::vector<std::int32_t> members = numbers_from(first, member.count);
    first += static_cast<std::int32_t>(member.count);
    if (members.empty() || member.locked.size() > 0) continue;
    const Sites own = select(sites, members);
    const Surface surface = member.domain->sampling_surface(member.count);
    if (!has_gaps(surface) && !is_thin_shell(*member.domain, surface, own)) continue;
    const Evened next = evened(*member.domain, own, seed, context);
    put(sites, members, next.sites);
    evaluations += next.evaluations;
  }
  return evaluations;
}

/// The share of the time that the start takes. Several classes are evaluated twice.
double share_of_start(const ClassProblem& problem, const ClassOptions& options) {
  if (options.sample.start == Start::kRandom) return 0.0;
  const double starting = can_subdivide(problem, options) ? kSubdividing : kStarting;
  const double evaluations = expected_evaluations(options.sample.optimizer);
  return starting / (starting + evaluations * (problem.classes.size() > 1 ? 2.0 : 1.0));
}

/// Continue the optimization where the first steps gain little, but later ones gain more: on thin
/// parts, where the start is nearly even, and where sharp edges and steps of the surface leave the
/// capacities uneven.
void go_on(ClassMinimum& found, OptimizerOptions options, Context* context) {
  options.max_evaluations = std::min(kMore, options.max_evaluations - found.minimum.evaluations);
  if (options.max_evaluations < 1 ||
      capacity_variation(found.objective, found.minimum.state) <= kEven) {
    if (context) context->advance(1.0);
    return;
  }
  options.tolerance *= kThin;
  Minimum next = minimize(found.objective, found.minimum.state.sites, options, context);
  next.count(found.minimum);
  next.converged = next.converged || found.minimum.converged;
  found.minimum = std::move(next);
  end_apart(found.objective, options, found.minimum, nullptr);
}

/// Whether sites may go anywhere, and nothing but equal cells is wanted.
bool is_plain(const ClassProblem& problem, const ClassOptions& options) {
  return is_one_free_class(problem) && options.sample.optimizer.method == Method::kTrustRegion &&
         options.sample.optimizer.capacity_weight >= kUseful;
}

/// Whether the capacities vary by more than a limit, the tolerance and whole numbers account for.
bool is_uneven(const ClassProblem& problem, const OptimizerOptions& options,
               const Objective& objective, const Evaluation& state, double limit) {
  const double loose = std::max(1.0, options.tolerance / OptimizerOptions().tolerance);
  const double uneven = limit * std::sqrt(loose);
  const double variation = capacity_variation(objective, state);
  // On even surfaces nobody has to look for islands.
  return variation > uneven &&
         variation > std::hypot(uneven, whole_count_variation(*problem.all, state.sites));
}

/// Minimize. If cells are still far from even after the first steps, as on machines and characters
/// made of parts, whose samples cannot go around, move sites there once: early moves save the steps
/// to a minimum that later ones leave. Random starts are far from even everywhere.
ClassMinimum solve_moving(const ClassProblem& problem, Objective objective, const Sites& start,
                          const ClassOptions& options, Context* context) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  int steps = 0;
  Aim aim;
  if (options.sample.start == Start::kPoisson && start.size() >= kMany)
    aim.pauses = [&](const Evaluation& state, double decrease) {
      return ++steps >= kFirstSteps && decrease < kSlow * optimizer.tolerance &&
             is_uneven(problem, optimizer, objective, state, kFarFromEven);
    };
  Minimum found = minimize(objective, start, optimizer, context, {}, aim);
  if (found.paused) {
    Minimum before;
    before.count(found);
    const Evened moved = evened(*problem.all, found.state.sites, options.sample.seed, nullptr);
    before.evaluations += moved.evaluations;
    OptimizerOptions rest = optimizer;
    rest.max_evaluations = evaluations_left(optimizer, before);
    Stretch going_on(context, context ? context->progress() : 0.0, 1.0);
    found = minimize(objective, moved.sites, rest, going_on.context());
    found.count(before);
  }
  return {std::move(objective), std::move(found)};
}

/// Where parts are hardly connected, steps end at a minimum in which some neighborhoods have a site
/// too many and others one too few. Move such sites and continue from there, as long as that lowers
/// the energy. Where only few are to move, trade single ones between parts instead.
/// \return evaluations of a last trade that did not lower the energy
int move_over(const ClassProblem& problem, const ClassOptions& options, ClassMinimum& found,
              Context* context) {
  OptimizerOptions rest = options.sample.optimizer;
  double done = 0.0;
  bool in_vain = false;  // whether the last moves did not lower the energy
  const auto is_not_even = [&] {
    return is_uneven(problem, rest, found.objective, found.minimum.state, kUneven);
  };
  for (int round = 1; round <= kMoves && is_not_even(); ++round) {
    if (found.minimum.evaluations + kMoved >= options.sample.optimizer.max_evaluations) break;
    const double before = std::exchange(done, done + kRound * (1.0 - done));
    const double moved = before + kMoving * (done - before);
    Stretch moving(context, before, moved), stepping(context, moved, done);
    const std::uint64_t seed = options.sample.seed + static_cast<std::uint64_t>(round);
    Evened start = in_vain
                       ? Evened{}
                       : evened(*problem.all, found.minimum.state.sites, seed, moving.context());
    const int evaluations = found.minimum.evaluations + start.evaluations;
    const bool single = start.moved < kFewest;
    if (single)
      start = is_uneven(problem, rest, found.objective, found.minimum.state, kTrading)
                  ? traded(*problem.all, found.minimum.state, seed)
                  : Evened{};
    if (start.moved == 0) {
      found.minimum.evaluations = evaluations;
      found.minimum.converged = found.minimum.converged || found.minimum.settled;
      break;
    }
    rest.max_evaluations = std::max(1, options.sample.optimizer.max_evaluations - evaluations);
    Minimum next = minimize(found.objective, start.sites, rest, stepping.context());
    found.minimum.evaluations = next.evaluations += evaluations;
    next.iterations += found.minimum.iterations;
    in_vain = !(next.state.total < found.minimum.state.total);
    if (!in_vain) {
      found.minimum = std::move(next);
      continue;
    }
    // Not even another start leads lower.
    found.minimum.converged = found.minimum.converged || next.settled;
    if (single) return next.evaluations - evaluations;
  }
  return 0;
}

/// Whether the energy jumps at few steps only. Where every second one fails, more of them gain
/// little.
bool most_steps_lead_on(int evaluations, int iterations) {
  return evaluations < kPerStep * iterations;
}

/// What steps of all sites leave to do: numbers that are off, cells that are not even, and sites
/// that are too near to each other.
void finish(const ClassProblem& problem, const ClassOptions& options, ClassMinimum& found,
            Context* context) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  Stretch moving(context, 0.0, kOver), going_on(context, kOver, kEnding),
      ending(context, kEnding, 1.0);
  const int vain = move_over(problem, options, found, moving.context());
  const Minimum& now = found.minimum;
  if (!problem.all->has_bodies() && most_steps_lead_on(now.evaluations - vain, now.iterations) &&
      is_uneven(problem, optimizer, found.objective, found.minimum.state, kUneven))
    go_on(found, optimizer, going_on.context());
  mend_places(found.objective, optimizer, found.minimum, ending.context());
}

/// Whether all classes have the same density, so that their union has it too.
bool alike(const ClassProblem& problem) {
  return std::all_of(problem.classes.begin(), problem.classes.end(), [&](const auto& member) {
    return member.domain == problem.classes[0].domain;
  });
}

/// The classes that are not empty, in groups of similar counts.
std::vector<std::vector<std::size_t>> groups_by_count(const ClassProblem& problem) {
  std::vector<std::size_t> counts;
  counts.reserve(problem.classes.size());
  for (const ClassProblem::Member& member : problem.classes) counts.push_back(member.count);
  std::vector<std::vector<std::size_t>> groups = dapple::groups_by_count(counts);
  std::erase_if(groups, [&](const auto& group) { return counts[group[0]] == 0; });
  return groups;
}

/// Places classes one group after another, each around the previous ones.
class InTurn {
 public:
  InTurn(const ClassProblem& problem, const ClassOptions& options)
      : options_(options),
        around_{problem.classes[0].domain, {}},
        placed_(problem.classes.size()) {}

  void place(const ClassProblem& problem, const std::vector<std::size_t>& group, Context* context) {
    ClassProblem now = around_;
    for (const std::size_t c : group) now.classes.push_back(problem.classes[c]);
    const double started = share_of_start(now, options_);
    Stretch starting(context, 0.0, started), solving(context, started, 1.0);
    std::size_t along = 0;
    Sites sites =
        make_start(now, options_.sample.start, options_.sample.seed, starting.context(), &along);
    along_ += along;
    sum_.evaluations += settle_islands(now, options_.sample.seed, sites, nullptr);
    Objective objective = make_objective(now, class_of_sites(now), options_, locked_sites(now));
    if (!around_.classes.empty()) leave_out_locked(objective);
    OptimizerOptions rough = options_.sample.optimizer;
    rough.tolerance = std::max(kRough, rough.tolerance);
    rough.max_evaluations = (evaluations_left(rough, sum_) + 1) / 2;
    const Minimum found = minimize(objective, sites, rough, solving.context());
    sum_.count(found);
    keep(now, group, discs_apart(objective, found.state.sites, nullptr));
  }

  [[nodiscard]] const Minimum& sum() const { return sum_; }

  /// Whether most sites are on thin parts.
  [[nodiscard]] bool thin() const { return 2 * along_ > sites().size(); }

  /// All sites, class by class.
  [[nodiscard]] Sites sites() const {
    Sites all;
    for (const Sites& own : placed_) append(all, own);
    return all;
  }

 private:
  void keep(ClassProblem& now, const std::vector<std::size_t>& group, const Sites& sites) {
    std::int32_t first = 0;
    for (std::size_t k = 0; k < now.classes.size(); ++k) {
      const std::vector<std::int32_t> members = numbers_from(first, now.classes[k].count);
      first += static_cast<std::int32_t>(members.size());
      if (k < around_.classes.size()) continue;
      now.classes[k].locked = select(sites, members);
      placed_[group[k - around_.classes.size()]] = now.classes[k].locked;
    }
    around_ = std::move(now);
  }

  ClassOptions options_;
  ClassProblem around_;
  std::vector<Sites> placed_;
  Minimum sum_;
  std::size_t along_ = 0;
};

bool goes_in_turn(const ClassProblem& problem, const ClassOptions& options) {
  return !options.two_stages && options.sample.start == Start::kPoisson &&
         options.sample.optimizer.method == Method::kTrustRegion && alike(problem);
}

/// Place rare classes first, then the others around them, then optimize all together. With one
/// start for all classes, a few large cells would be crowded by many small ones.
ClassMinimum solve_in_turn(const ClassProblem& problem,
                           const std::vector<std::vector<std::size_t>>& groups,
                           const ClassOptions& options, Context* context) {
  InTurn turn(problem, options);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const auto share = [&](std::size_t j) {
      return kInTurn * static_cast<double>(j) / static_cast<double>(groups.size());
    };
    Stretch placing(context, share(k), share(k + 1));
    turn.place(problem, groups[k], placing.context());
  }
  const double first = turn.thin() ? kInTurn + kRound * (1.0 - kInTurn) : 1.0;
  Stretch together(context, kInTurn, first), going_on(context, first, 1.0);
  Objective objective =
      make_objective(problem, class_of_sites(problem), options, locked_sites(problem));
  objective.holds_discs = !objective.discs.empty();
  OptimizerOptions rest = options.sample.optimizer;
  rest.max_evaluations = evaluations_left(rest, turn.sum());
  rest.tolerance *= kPolish;
  ClassMinimum found = solve(std::move(objective), turn.sites(), rest, together.context());
  if (turn.thin()) go_on(found, options.sample.optimizer, going_on.context());
  found.minimum.count(turn.sum());
  return found;
}

}  // namespace

ClassMinimum solve(Objective objective, const Sites& start, const OptimizerOptions& options,
                   Context* context) {
  double done = objective.discs.empty() ? 1.0 : kRound;
  Stretch first(context, 0.0, done);
  Minimum found =
      minimize(objective, objective.holds_discs ? discs_apart(objective, start, context) : start,
               options, first.context());
  for (int round = 1;; ++round) {
    if (objective.holds_discs || worst_overlap(found.state.discs) <= kOverlap)
      end_apart(objective, options, found, context);
    if (round == kRounds || worst_overlap(found.state.discs) <= kOverlap) break;
    objective.discs_weight *= kHarder;
    objective.holds_discs = true;
    const double before = std::exchange(done, done + kRound * (1.0 - done));
    Stretch harder(context, before, done);
    OptimizerOptions rest = options;
    rest.max_evaluations = evaluations_left(options, found);
    Minimum next = minimize(objective, discs_apart(objective, found.state.sites, context), rest,
                            harder.context());
    next.count(found);
    found = std::move(next);
  }
  return {std::move(objective), std::move(found)};
}

namespace {

struct Beginning {
  Sites sites;
  bool thin = false;  // whether most sites are on thin parts
  int evaluations = 0;
};

Beginning begin(const ClassProblem& problem, const ClassOptions& options, Context* context) {
  if (can_subdivide(problem, options)) {
    SubdividedStart found = subdivided_start(problem, options, context);
    if (found.sites.size() > 0) return {std::move(found.sites), false, found.evaluations};
  }
  std::size_t along = 0;
  Sites sites = make_start(problem, options.sample.start, options.sample.seed, context, &along);
  const bool thin = 2 * along > sites.size();
  return {std::move(sites), thin};
}

}  // namespace

ClassMinimum solve(const ClassProblem& problem, const ClassOptions& options, Context* context) {
  check(problem, options);
  const std::vector<std::vector<std::size_t>> groups = groups_by_count(problem);
  if (groups.size() > 1 && goes_in_turn(problem, options))
    return solve_in_turn(problem, groups, options, context);
  const double started = share_of_start(problem, options);
  Stretch starting(context, 0.0, started);
  auto [start, thin, evaluations] = begin(problem, options, starting.context());
  if (context) context->advance(started);
  const bool stages = options.two_stages && problem.classes.size() > 1;
  const double together = stages ? started + kAlone * (1.0 - started) : started;
  Stretch alone(context, started, together);
  const bool plain = is_plain(problem, options);
  const double last = plain ? together + kNearly * (1.0 - together) : 1.0;
  const double first = thin ? together + kRound * (last - together) : last;
  Stretch finishing(context, together, first), going_on(context, first, last),
      moving(context, last, 1.0);
  Minimum before;
  before.evaluations = evaluations;
  if (options.sample.start == Start::kPoisson)
    before.evaluations += settle_islands(problem, options.sample.seed, start, nullptr);
  if (stages) settle_alone(problem, options, start, before, alone.context());
  Objective objective =
      make_objective(problem, class_of_sites(problem), options, locked_sites(problem));
  OptimizerOptions optimizer = options.sample.optimizer;
  if (objective.terms.size() > 1 && optimizer.method == Method::kTrustRegion)
    optimizer.tolerance *= kJoint;
  ClassMinimum found =
      plain ? solve_moving(problem, std::move(objective), start, options, finishing.context())
            : solve(std::move(objective), start, optimizer, finishing.context());
  if (thin) go_on(found, options.sample.optimizer, going_on.context());
  if (plain) finish(problem, options, found, moving.context());
  found.minimum.count(before);
  return found;
}

}  // namespace dapple
