// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/neighbours.hpp>
#include <dapple/resample.hpp>
#include <numeric>

#include "class_start.hpp"
#include "clock.hpp"
#include "outcome.hpp"
#include "parallel.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

constexpr double kSlack = 5e-4;  // of the normalised energy: as even to the eye, as in the tracker
constexpr double kApart = 2.5;   // spacings between samples taken out, while there is room for that

/// The samples by the distance to their nearest neighbour, nearest first.
std::vector<std::size_t> by_crowding(const std::vector<Vec3>& positions) {
  const Neighbours tree(positions);
  std::vector<double> nearest(positions.size(), 0.0);
  std::vector<Neighbour> found;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    tree.nearest(positions[k], 2, found);
    if (found.size() > 1) nearest[k] = found[1].squared_distance;
  }
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return nearest[a] != nearest[b] ? nearest[a] < nearest[b] : a < b;
  });
  return order;
}

/// Which samples stay when `surplus` go.
std::vector<std::size_t> thin_out(const Samples& samples, std::size_t surplus, double spacing) {
  std::vector<bool> gone(samples.size(), false);
  const std::vector<std::size_t> order = by_crowding(samples.positions);
  const Neighbours tree(samples.positions);
  std::vector<Neighbour> found;
  for (double apart = kApart * spacing; surplus > 0;
       apart = apart > 0.1 * spacing ? 0.5 * apart : 0.0)
    for (std::size_t k = 0; k < order.size() && surplus > 0; ++k) {
      if (gone[order[k]]) continue;
      tree.within(samples.positions[order[k]], apart, found);
      if (std::any_of(found.begin(), found.end(),
                      [&](const Neighbour& n) { return gone[static_cast<std::size_t>(n.index)]; }))
        continue;
      gone[order[k]] = true;
      --surplus;
    }
  std::vector<std::size_t> stay;
  for (std::size_t k = 0; k < gone.size(); ++k)
    if (!gone[k]) stay.push_back(k);
  return stay;
}

/// The samples that stay, bound to the surface.
Samples keep(const Surface& surface, const Samples& samples, std::size_t count) {
  Samples all = bind_samples(surface, samples.faces, samples.barycentric, samples.ids);
  if (count >= all.size()) return all;
  std::vector<std::int32_t> faces, ids;
  std::vector<Vec3> barycentric;
  for (const std::size_t k : thin_out(all, all.size() - count, surface.spacing(all.size()))) {
    faces.push_back(all.faces[k]);
    barycentric.push_back(all.barycentric[k]);
    ids.push_back(all.ids[k]);
  }
  return bind_samples(surface, faces, barycentric, ids);
}

/// As many more ids as are missing, from above the largest on.
std::vector<std::int32_t> continued(std::vector<std::int32_t> ids, std::size_t count) {
  const std::int64_t last = ids.empty() ? -1 : *std::max_element(ids.begin(), ids.end());
  const std::size_t missing = count - std::min(count, ids.size());
  check_ids_left(last, missing);
  for (std::size_t k = 1; k <= missing; ++k)
    ids.push_back(static_cast<std::int32_t>(last + static_cast<std::int64_t>(k)));
  return ids;
}

}  // namespace

Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                 const SampleOptions& options, Context* context) {
  const Clock clock;
  if (context) context->check();
  check_count("count", count);
  check_none_locked("locked", options.locked, "all may move a little here");
  Samples result = with_threads(options.threads, [&] {
    const Samples kept = keep(surface, samples, count);
    const std::vector<std::int32_t> ids = continued(kept.ids, count);
    const ClassStarts starts{
        {{&surface, count, 0.0, {kept.positions, kept.faces, kept.barycentric}}},
        &surface,
        0.0,
        options.seed};
    OptimizerOptions optimizer = options.optimizer;
    if (samples.report.energy > 0.0)
      optimizer.target_energy = std::max(optimizer.target_energy, samples.report.energy + kSlack);
    const SurfaceDomain domain(surface, options.cells);
    OptimizerResult found = optimize(domain, poisson_start(starts, context), optimizer, context);
    Samples even = to_samples(surface, domain, std::move(found), ids);
    measure_slide(even.report, even.positions, kept.positions);
    return even;
  });
  result.report.seconds = clock.seconds();
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
