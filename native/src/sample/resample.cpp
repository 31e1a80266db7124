// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/poisson_start.hpp>
#include <dapple/resample.hpp>
#include <functional>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "optimize/chosen_sites.hpp"
#include "optimize/minimizer.hpp"
#include "rebalance/fit_among_locked.hpp"
#include "rebalance/lead_to_density.hpp"
#include "rebalance/rebalance.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

// Share of the progress before the optimization if there are no samples.
constexpr double kStarted = 0.3;
constexpr double kEvening =
    24.0;                      // otherwise the optimization takes as long as this many evaluations
constexpr double kNear = 0.5;  // spacings: a site this close to a face with density is kept
constexpr double kAsVaried = 1.25;  // of the previous capacity variation: counts as equally even
constexpr double kSame = 1e-12;     // of the coordinates: a locked sample has not moved farther

/// The start of an optimization: the remaining samples, then the new ones.
struct Beginning {
  Samples kept;
  Sites sites;
  int evaluations = 0;
  std::vector<bool> locked = {};  // per site; empty: none
  std::vector<std::size_t> rows =
      {};  // previous rows of the remaining samples; empty without locked ones
};

Beginning begin_anew(const Surface& surface, std::size_t count, std::uint64_t seed,
                     Context* context) {
  return {bind_samples(surface, {}, {}), poisson_start(surface, count, seed, context)};
}

void add(const Sites& from, std::size_t k, Sites& sites) {
  sites.positions.push_back(from.positions[k]);
  sites.faces.push_back(from.faces[k]);
  sites.barycentric.push_back(from.barycentric[k]);
}

template <typename T>
std::vector<T> chosen(const std::vector<T>& from, const std::vector<std::size_t>& which) {
  std::vector<T> result;
  result.reserve(which.size());
  for (const std::size_t k : which) result.push_back(from[k]);
  return result;
}

/// Sites among locked ones: remove crowded ones and insert new ones into the widest gaps.
Beginning begin_among_locked(const Surface& surface, const Domain& domain, const Samples& samples,
                             std::span<const std::int32_t> which, std::size_t count,
                             std::uint64_t seed, Context* context) {
  Sites sites{samples.positions, samples.faces, samples.barycentric};
  std::vector<bool> locked(sites.size(), false);
  for (const std::int32_t k : which) locked[static_cast<std::size_t>(k)] = true;
  std::vector<std::size_t> rows = lead_near_ones(
      surface, domain, sites, {locked, kNear * surface.spacing(count), false}, context);
  sites = select(sites, rows);
  locked = chosen(locked, rows);
  const FittedSites fitted =
      fit_among_locked(domain.sampling_surface(count), domain, sites, locked, count, seed, context);
  rows = chosen(rows, fitted.stay);
  Beginning result{bind_samples(surface, chosen(samples.faces, rows),
                                chosen(samples.barycentric, rows), chosen(samples.ids, rows)),
                   select(sites, fitted.stay), fitted.evaluations, chosen(locked, fitted.stay),
                   rows};
  const std::size_t missing = count - result.sites.size();
  append(result.sites, fitted.fresh);
  if (fitted.fresh.size() < missing)
    throw ArgumentError("count is " + std::to_string(count) + ", but there are places for only " +
                        std::to_string(result.sites.size()) + " samples");
  result.locked.resize(count, false);
  return result;
}

Beginning begin(const Surface& surface, const Domain& domain, const Samples& samples,
                std::span<const std::int32_t> locked, std::size_t count, std::uint64_t seed,
                Context* context) {
  const Samples all = bind_samples(surface, samples.faces, samples.barycentric, samples.ids);
  if (all.size() == 0 || count == 0) return begin_anew(surface, count, seed, context);
  if (!locked.empty())
    return begin_among_locked(surface, domain, all, locked, count, seed, context);
  const Sites there{all.positions, all.faces, all.barycentric};
  const Rebalanced found = rebalance(domain, there, count, seed, context);
  std::vector<std::int32_t> ids;
  Sites sites;
  for (const std::size_t k : found.stay) {
    add(there, k, sites);
    ids.push_back(all.ids[k]);
  }
  const Samples kept = bind_samples(surface, sites.faces, sites.barycentric, ids);
  lead_to_density(surface, domain, sites);
  for (std::size_t k = 0; k < found.fresh.size(); ++k) add(found.fresh, k, sites);
  return {kept, std::move(sites), found.evaluations};
}

/// The share of the time that is spent before the optimization.
double beginning(std::size_t sites, std::size_t count) {
  if (sites == 0 || count == 0) return kStarted;
  const double work = rebalancing_work(sites, count);
  return work / (work + kEvening * static_cast<double>(count));
}

/// The largest id; samples without ids are numbered from 0.
std::int64_t last_id(const Samples& samples) {
  if (samples.ids.empty()) return static_cast<std::int64_t>(samples.size()) - 1;
  return *std::max_element(samples.ids.begin(), samples.ids.end());
}

/// New ids, starting above the largest id ever used.
std::vector<std::int32_t> continued(std::vector<std::int32_t> ids, std::int64_t last,
                                    std::size_t count) {
  const std::size_t missing = count - std::min(count, ids.size());
  check_ids_left(last, missing);
  for (std::size_t k = 1; k <= missing; ++k)
    ids.push_back(static_cast<std::int32_t>(last + static_cast<std::int64_t>(k)));
  return ids;
}

void check_locked(std::span<const std::int32_t> locked, const Samples& samples, std::size_t count) {
  std::vector<bool> is_locked(samples.size(), false);
  for (std::size_t k = 0; k < locked.size(); ++k) {
    if (locked[k] < 0 || static_cast<std::size_t>(locked[k]) >= samples.size())
      throw ArgumentError(entry("locked", k) + " is " + std::to_string(locked[k]) +
                          ", outside 0.." + std::to_string(samples.size() - 1));
    is_locked[static_cast<std::size_t>(locked[k])] = true;
  }
  const auto stay = static_cast<std::size_t>(std::count(is_locked.begin(), is_locked.end(), true));
  if (stay > count)
    throw ArgumentError("count is " + std::to_string(count) + ", and " + std::to_string(stay) +
                        " samples are locked: the count includes them");
}

/// The target evenness: that of the given samples, or the best that locked ones allow.
OptimizerResult even_out(const Domain& domain, const Beginning& first, const Samples& samples,
                         OptimizerOptions options, Context* context) {
  Aim aim;
  if (samples.report.energy > 0.0 && first.locked.empty()) {
    options.target_energy = std::max(options.target_energy, samples.report.energy + kAsEven);
    aim.variation = kAsVaried * samples.report.evenness.capacity_variation;
  }
  const Objective objective{.capacity_weight = options.capacity_weight,
                            .terms = {{.domain = &domain,
                                       .repulsion_radius = options.repulsion_radius,
                                       .repulsion_weight = options.repulsion_weight}},
                            .locked = first.locked};
  Minimum found = minimize(objective, first.sites, options, context, {}, aim);
  return {.sites = std::move(found.state.sites),
          .energy = std::move(found.state.parts[0].energy),
          .energies = std::move(found.energies),
          .evaluations = found.evaluations + first.evaluations,
          .iterations = found.iterations,
          .converged = found.converged};
}

/// Locked samples keep their exact positions unless the surface has moved.
void restore_locked(const Samples& before, const Beginning& first, Samples& after) {
  for (std::size_t k = 0; k < first.rows.size(); ++k) {
    const std::size_t row = first.rows[k];
    const double size = after.positions[k].cwiseAbs().maxCoeff();
    const double moved = (after.positions[k] - before.positions[row]).cwiseAbs().maxCoeff();
    if (!first.locked[k] || after.faces[k] != before.faces[row] || !(moved <= kSame * size) ||
        !before.positions[row].allFinite())  // maxCoeff() may ignore NaN
      continue;
    after.positions[k] = before.positions[row];
    after.barycentric[k] = before.barycentric[row];
  }
}

/// The class of all samples; 0 if they are of several.
std::int32_t common_class(const Samples& samples) {
  const std::vector<std::int32_t>& classes = samples.classes;
  if (classes.empty() || std::ranges::adjacent_find(classes, std::not_equal_to()) != classes.end())
    return 0;
  return classes.front();
}

}  // namespace

Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                 const ResampleOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check_count("count", count);
  check_options(options);
  check_locked(options.locked, samples, count);
  Samples result = with_threads(options.threads, [&] {
    const SurfaceDomain domain(surface, options.cells, sides_for(surface, count, options.cells),
                               EmptyFaces::kLeft);
    const double begun = beginning(samples.size(), count);
    Stretch starting(call.context(), 0.0, begun), evening(call.context(), begun, 1.0);
    const Beginning first = in_stage(call.context(), Stage::kStart, [&] {
      return begin(surface, domain, samples, options.locked, count, options.seed,
                   starting.context());
    });
    const std::vector<std::int32_t> ids = continued(first.kept.ids, last_id(samples), count);
    OptimizerResult found = even_out(domain, first, samples, options.optimizer, evening.context());
    const StageSpan reporting(call.context(), Stage::kReporting);
    Samples even = to_samples(surface, domain, std::move(found), ids);
    restore_locked(samples, first, even);
    even.classes.assign(even.size(), common_class(samples));
    measure_slide(even.report, even.positions, first.kept.positions);
    return even;
  });
  call.write(result.report);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
