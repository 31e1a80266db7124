// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/subdivided_start.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "optimize/chosen_sites.hpp"
#include "optimize/minimizer.hpp"
#include "rebalance/rebalance.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFewest = 150;  // sites to begin with: fewer have no patches
constexpr std::size_t kParts = 4;     // by which a subdivision multiplies them
constexpr int kSteps = 20;            // evaluations of a level: defects that are left stay few
// Share of the sites that may go and come after a subdivision so that each neighborhood has its
// number: where it takes more, the surface or its density has parts that fewer sites do not
// resolve.
constexpr double kMostMoved = 0.1;
constexpr double kFirst = 0.4;   // share of the progress for all levels before the last
constexpr double kSolved = 0.9;  // share of a level's progress for its optimization

std::size_t quarter(std::size_t count) { return (count + kParts - 1) / kParts; }

ClassProblem with_count(const ClassProblem& problem, std::size_t count) {
  ClassProblem result = problem;
  result.classes[0].count = count;
  return result;
}

/// The middles of the edges between neighbors, on the surface.
Sites edge_middles(const Domain& domain, const Sites& sites, const RestrictedVoronoi& diagram,
                   const Context* context) {
  Vectors middles;
  std::vector<std::int32_t> hints;
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (const CellBoundary& boundary : diagram.boundary(i))
      if (static_cast<std::size_t>(boundary.neighbor) > i) {
        middles.push_back(sites.positions[i] + 0.5 * boundary.offset);
        hints.push_back(sites.faces[i]);
      }
  return domain.project(middles, hints, context);
}

/// How many sites go and come.
std::size_t moved(const Rebalanced& found, std::size_t before) {
  return before - found.stay.size() + found.fresh.size();
}

Sites remaining(const Sites& sites, const Rebalanced& found) {
  const std::vector<std::int32_t> stay(found.stay.begin(), found.stay.end());
  Sites result = select(sites, stay);
  append(result, found.fresh);
  return result;
}

class Subdivision {
 public:
  Subdivision(const ClassProblem& problem, const ClassOptions& options)
      : problem_(problem), options_(options) {}

  /// So many sites, before they are optimized; none where the surface is thinner than the spacing
  /// of those to begin with.
  Sites begin(std::size_t count, Context* context) {
    if (count < kParts * kFewest) return first(count, context);
    const std::size_t few = quarter(count);
    Stretch coarser(context, 0.0, kFirst), solving(context, kFirst, kSolved),
        dividing(context, kSolved, 1.0);
    Sites start = begin(few, coarser.context());
    if (start.size() == 0) return start;
    const Minimum found = optimized(start, few, solving.context());
    const StageSpan starting(context, Stage::kStart);
    Sites sites = found.state.sites;
    append(sites, edge_middles(*problem_.all, sites, found.state.diagram(), context));
    const Rebalanced fitted =
        rebalance(*problem_.all, sites, count, options_.sample.seed, dividing.context());
    note(found.evaluations, few);
    note(fitted.evaluations, count);
    if (static_cast<double>(moved(fitted, sites.size())) > kMostMoved * static_cast<double>(count))
      return first(count, nullptr);
    return remaining(sites, fitted);
  }

  [[nodiscard]] int evaluations() const { return static_cast<int>(std::lround(work_)); }

 private:
  Sites first(std::size_t count, Context* context) const {
    std::size_t along = 0;
    const Sites sites = make_start(with_count(problem_, count), Start::kPoisson,
                                   options_.sample.seed, context, &along);
    return 2 * along > count ? Sites() : sites;
  }

  Minimum optimized(const Sites& start, std::size_t count, Context* context) const {
    const ClassProblem problem = with_count(problem_, count);
    OptimizerOptions optimizer = options_.sample.optimizer;
    optimizer.max_evaluations = std::min(kSteps, optimizer.max_evaluations);
    return minimize(make_objective(problem, class_of_sites(problem), options_), start, optimizer,
                    context);
  }

  void note(int evaluations, std::size_t count) {
    work_ +=
        evaluations * static_cast<double>(count) / static_cast<double>(problem_.classes[0].count);
  }

  const ClassProblem& problem_;
  const ClassOptions& options_;
  double work_ = 0.0;
};

}  // namespace

bool can_subdivide(const ClassProblem& problem, const ClassOptions& options) {
  const OptimizerOptions& optimizer = options.sample.optimizer;
  return is_one_free_class(problem) && options.sample.start == Start::kPoisson &&
         optimizer.method == Method::kTrustRegion && is_lattice(optimizer.capacity_weight) &&
         problem.classes[0].count >= kParts * kFewest;
}

SubdividedStart subdivided_start(const ClassProblem& problem, const ClassOptions& options,
                                 Context* context) {
  Subdivision subdivision(problem, options);
  Sites sites = subdivision.begin(problem.classes[0].count, context);
  return {std::move(sites), subdivision.evaluations()};
}

}  // namespace dapple
