// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/poisson_start.hpp>
#include <dapple/resample.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/lead_to_density.hpp"
#include "sample/outcome.hpp"
#include "sample/rebalance.hpp"
#include "sample/timed_call.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

// Of the progress: before the optimization, after a start from nothing ...
constexpr double kStarted = 0.3;
constexpr double kEvening = 24.0;  // ... else it takes as long as so many evaluations of each cell

/// Where an optimization begins: those that stay, then the new ones.
struct Beginning {
  Samples kept;
  Sites sites;
  int evaluations = 0;
};

Beginning begin_anew(const Surface& surface, std::size_t count, std::uint64_t seed,
                     Context* context) {
  return {bind_samples(surface, {}, {}), poisson_start(surface, count, seed, context)};
}

Beginning begin(const Surface& surface, const Domain& domain, const Samples& samples,
                std::size_t count, std::uint64_t seed, Context* context) {
  const Samples all = bind_samples(surface, samples.faces, samples.barycentric, samples.ids);
  if (all.size() == 0 || count == 0) return begin_anew(surface, count, seed, context);
  const Sites there{all.positions, all.faces, all.barycentric};
  const Rebalanced found = rebalance(domain, there, count, seed, context);
  std::vector<std::int32_t> ids;
  Sites sites;
  const auto add = [&sites](const Sites& from, std::size_t k) {
    sites.positions.push_back(from.positions[k]);
    sites.faces.push_back(from.faces[k]);
    sites.barycentric.push_back(from.barycentric[k]);
  };
  for (const std::size_t k : found.stay) {
    add(there, k);
    ids.push_back(all.ids[k]);
  }
  const Samples kept = bind_samples(surface, sites.faces, sites.barycentric, ids);
  lead_to_density(surface, domain, sites);
  for (std::size_t k = 0; k < found.fresh.size(); ++k) add(found.fresh, k);
  return {kept, std::move(sites), found.evaluations};
}

/// The share of the time before the optimization.
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

/// As many more ids as are missing, from above the last that was ever used on.
std::vector<std::int32_t> continued(std::vector<std::int32_t> ids, std::int64_t last,
                                    std::size_t count) {
  const std::size_t missing = count - std::min(count, ids.size());
  check_ids_left(last, missing);
  for (std::size_t k = 1; k <= missing; ++k)
    ids.push_back(static_cast<std::int32_t>(last + static_cast<std::int64_t>(k)));
  return ids;
}

}  // namespace

Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                 const SampleOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check_count("count", count);
  check_none_locked("locked", options.locked, "all may move a little here");
  Samples result = with_threads(options.threads, [&] {
    const SurfaceDomain domain(surface, options.cells, Steps::kAnywhere,
                               sides_for(surface, count, options.cells), EmptyFaces::kLeft);
    const double begun = beginning(samples.size(), count);
    Stretch starting(call.context(), 0.0, begun), evening(call.context(), begun, 1.0);
    const Beginning first = in_stage(call.context(), Stage::kStart, [&] {
      return begin(surface, domain, samples, count, options.seed, starting.context());
    });
    OptimizerOptions optimizer = options.optimizer;
    if (samples.report.energy > 0.0)
      optimizer.target_energy = std::max(optimizer.target_energy, samples.report.energy + kAsEven);
    const std::vector<std::int32_t> ids = continued(first.kept.ids, last_id(samples), count);
    OptimizerResult found = optimize(domain, first.sites, optimizer, evening.context());
    found.evaluations += first.evaluations;
    const StageSpan reporting(call.context(), Stage::kReporting);
    Samples even = to_samples(surface, domain, std::move(found), ids);
    measure_slide(even.report, even.positions, first.kept.positions);
    return even;
  });
  call.write(result.report);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
