// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/subdivided_start.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "optimize/chosen_sites.hpp"
#include "optimize/minimizer.hpp"
#include "rebalance/fit_among_locked.hpp"
#include "rebalance/rebalance.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFewest = 150;     // sites to begin with: fewer have no patches
constexpr std::size_t kParts = 4;        // by which a subdivision multiplies them
constexpr int kSteps = 14;               // evaluations of a level: defects that are left stay few
constexpr std::size_t kMostFaces = 150;  // per site: with more, fewer sites save no time
// Share of the sites that may go and come after a subdivision so that each neighborhood has its
// number: where it takes more, the surface or its density has parts that fewer sites do not
// resolve.
constexpr double kMostMoved = 0.1;
constexpr double kFirst = 0.4;   // share of the progress for all levels before the last
constexpr double kSolved = 0.9;  // share of a level's progress for its optimization

std::size_t quarter(std::size_t count) { return (count + kParts - 1) / kParts; }

ClassProblem with_count(const ClassProblem& problem, std::size_t count) {
  ClassProblem result = problem;
  ClassProblem::Member& only = result.classes[0];
  if (count != only.count && only.locked_among) only.locked = only.locked_among(count);
  only.count = count;
  return result;
}

/// A finer set of sites: locked ones first.
struct Divided {
  Sites sites;
  std::size_t locked = 0;
};

/// The middles of the edges between neighbors that are not both locked, on the surface.
Sites edge_middles(const Domain& domain, const Evaluation& state, std::size_t locked,
                   const Context* context) {
  const Sites& sites = state.sites;
  Vectors middles;
  std::vector<std::int32_t> hints;
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (const CellBoundary& boundary : state.diagram().boundary(i)) {
      const auto j = static_cast<std::size_t>(boundary.neighbor);
      if (j <= i || j < locked) continue;
      middles.push_back(sites.positions[i] + 0.5 * boundary.offset);
      hints.push_back(sites.faces[i]);
    }
  return domain.project(middles, hints, context);
}

/// Locked sites in place of those of the coarser level, its other sites, and edge middles.
Divided divided(const Domain& domain, const Evaluation& state, std::size_t locked,
                const Sites& locked_now, const Context* context) {
  Divided result{locked_now, locked_now.size()};
  append(result.sites, without_first(state.sites, locked));
  append(result.sites, edge_middles(domain, state, locked, context));
  return result;
}

/// The number of sites that fits the count in each neighborhood.
FittedSites fitted(const Domain& domain, const Divided& given, std::size_t count,
                   std::uint64_t seed, Context* context) {
  if (given.locked == 0) {
    Rebalanced found = rebalance(domain, given.sites, count, seed, context);
    return {std::move(found.stay), std::move(found.fresh), found.evaluations};
  }
  std::vector<bool> locked(given.sites.size(), false);
  std::fill_n(locked.begin(), given.locked, true);
  return fit_among_locked(domain.sampling_surface(count), domain, given.sites, locked, count, seed,
                          context);
}

/// How many sites go and come.
std::size_t moved(const FittedSites& found, std::size_t before) {
  return before - found.stay.size() + found.fresh.size();
}

Sites remaining(const Sites& sites, const FittedSites& found) {
  Sites result = select(sites, found.stay);
  append(result, found.fresh);
  return result;
}

class Subdivision {
 public:
  Subdivision(const ClassProblem& problem, const ClassOptions& options)
      : problem_(problem),
        options_(options),
        faces_(problem.all->sampling_surface(problem.classes[0].count).face_count()) {}

  /// So many sites, before they are optimized; none where the surface is thinner than the spacing
  /// of those to begin with.
  Sites begin(std::size_t count, Context* context) {
    const ClassProblem problem = with_count(problem_, count);
    const std::size_t few = quarter(count);
    if (count < kParts * kFewest || faces_ > kMostFaces * few) return first(problem, context);
    const ClassProblem coarse = with_count(problem_, few);
    const std::size_t locked = coarse.classes[0].locked.size();
    if (2 * locked > few) return first(problem, context);  // lines hold most of them
    Stretch coarser(context, 0.0, kFirst), solving(context, kFirst, kSolved),
        dividing(context, kSolved, 1.0);
    Sites start = begin(few, coarser.context());
    if (start.size() == 0) return start;
    const Minimum found = optimized(coarse, start, solving.context());
    const StageSpan starting(context, Stage::kStart);
    const Divided finer =
        divided(*problem.all, found.state, locked, problem.classes[0].locked, context);
    const FittedSites sites =
        fitted(*problem.all, finer, count, options_.sample.seed, dividing.context());
    note(found.evaluations, few);
    note(sites.evaluations, count);
    const std::size_t changes = moved(sites, finer.sites.size());
    const bool fits = sites.stay.size() + sites.fresh.size() == count &&
                      static_cast<double>(changes) <= kMostMoved * static_cast<double>(count);
    return fits ? remaining(finer.sites, sites) : first(problem, nullptr);
  }

  [[nodiscard]] int evaluations() const { return static_cast<int>(std::lround(work_)); }

 private:
  Sites first(const ClassProblem& problem, Context* context) const {
    std::size_t along = 0;
    const Sites sites = make_start(problem, Start::kPoisson, options_.sample.seed, context, &along);
    return 2 * along > problem.classes[0].count ? Sites() : sites;
  }

  Minimum optimized(const ClassProblem& problem, const Sites& start, Context* context) const {
    OptimizerOptions optimizer = options_.sample.optimizer;
    optimizer.max_evaluations = std::min(kSteps, optimizer.max_evaluations);
    return minimize(
        make_objective(problem, class_of_sites(problem), options_, locked_sites(problem)), start,
        optimizer, context);
  }

  void note(int evaluations, std::size_t count) {
    work_ +=
        evaluations * static_cast<double>(count) / static_cast<double>(problem_.classes[0].count);
  }

  const ClassProblem& problem_;
  const ClassOptions& options_;
  std::size_t faces_;
  double work_ = 0.0;
};

}  // namespace

bool can_subdivide(const ClassProblem& problem, const ClassOptions& options) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  if (problem.classes.size() != 1) return false;
  const ClassProblem::Member& only = problem.classes[0];
  const bool any_count = only.locked.size() == 0 || only.locked_among;
  return any_count && only.radius == 0.0 && problem.all->period() == 0.0 &&
         options.sample.start == Start::kPoisson && optimizer.method == Method::kTrustRegion &&
         is_lattice(optimizer.capacity_weight) && only.count >= kParts * kFewest;
}

SubdividedStart subdivided_start(const ClassProblem& problem, const ClassOptions& options,
                                 Context* context) {
  Subdivision subdivision(problem, options);
  Sites sites = subdivision.begin(problem.classes[0].count, context);
  return {std::move(sites), subdivision.evaluations()};
}

}  // namespace dapple
