// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/outcome.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/energy.hpp>
#include <numeric>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/validate_samples.hpp"
#include "surface/islands.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kEvaluated =
    0.9;  // share of the progress of the analysis when the cells are known

/// The term of a class; the term of the union if there is no other class; -1 for an empty class.
std::int32_t term_of(const Objective& objective, std::size_t c) {
  const auto is_of_class = [&](std::int32_t site) {
    return objective.classes[static_cast<std::size_t>(site)] == static_cast<std::int32_t>(c);
  };
  for (std::size_t t = 1; t < objective.terms.size(); ++t)
    if (is_of_class(objective.terms[t].members[0])) return static_cast<std::int32_t>(t);
  return objective.terms.size() == 1 && !objective.classes.empty() && is_of_class(0) ? 0 : -1;
}

Quality measure_class(const Objective& objective, const Minimum& found, std::size_t c,
                      std::span<const Vec3> normals) {
  const std::int32_t t = term_of(objective, c);
  if (t < 0) return {};
  const Term& term = objective.terms[static_cast<std::size_t>(t)];
  const Energy& energy = found.state.parts[static_cast<std::size_t>(t)].energy;
  if (term.members.empty()) return measure(*term.domain, energy, found.state.sites, normals);
  Vectors mine;
  for (const std::int32_t site : term.members)
    mine.push_back(normals[static_cast<std::size_t>(site)]);
  return measure(*term.domain, energy, select(found.state.sites, term.members), mine);
}

}  // namespace

double whole_count_variation(const Domain& domain, const Sites& sites) {
  const Surface surface = domain.sampling_surface(sites.size());
  if (surface.ordered().components() < 2 && !has_gaps(surface)) return 0.0;
  const std::shared_ptr<const Islands> known = islands_of(surface);
  const Islands& islands = *known;
  if (islands.count() < 2 || sites.size() == 0) return 0.0;
  std::vector<double> counts(islands.count(), 0.0);
  for (const std::int32_t face : domain.to_sampling_surface(sites).faces)
    ++counts[islands.at(surface.ordered().ordered_face(face))];
  const double mean = surface.ordered().unit_capacity() / static_cast<double>(sites.size());
  double sum = 0.0;
  for (std::size_t c = 0; c < islands.count(); ++c) {
    if (counts[c] == 0.0) continue;
    const double off = islands.capacities()[c] / (counts[c] * mean) - 1.0;
    sum += counts[c] * (off * off);
  }
  return std::sqrt(sum / static_cast<double>(sites.size()));
}

Quality measure(const Domain& domain, const Energy& energy, const Sites& sites,
                std::span<const Vec3> normals) {
  return {
      .count = sites.size(),
      .spacing = domain.spacing(sites.size()),
      .evenness = measure_evenness(energy.diagram),
      .bond_order = bond_order(energy.diagram, normals, domain.on_border(sites, energy.diagram)),
      .energy = energy.normalized,
      .whole_count_variation = whole_count_variation(domain, sites)};
}

Report to_report(const Objective& objective, const Minimum& found, std::size_t class_count,
                 std::span<const Vec3> normals) {
  const Evaluation& state = found.state;
  Report report;
  static_cast<Quality&>(report) =
      measure(objective.domain(), state.parts[0].energy, state.sites, normals);
  for (std::size_t c = 0; c < class_count && class_count > 1; ++c)
    report.classes.push_back(measure_class(objective, found, c, normals));
  if (const ClosePair* worst = worst_pair(state.discs)) {
    report.worst_overlap = worst->overlap;
    report.overlapping = {worst->i, worst->j};
  }
  report.evaluations = found.evaluations;
  report.iterations = found.iterations;
  report.converged = found.converged;
  report.energies = found.energies;
  return report;
}

Samples to_samples(const Surface& surface, const Objective& objective, const Minimum& found,
                   std::size_t class_count, std::span<const std::int32_t> ids) {
  const Sites& sites = found.state.sites;
  Samples samples = bind_samples(surface, sites.faces, sites.barycentric, ids, objective.classes);
  samples.report = to_report(objective, found, class_count, samples.normals);
  return samples;
}

Samples to_samples(const Surface& surface, const Domain& domain, OptimizerResult&& found,
                   std::span<const std::int32_t> ids) {
  Samples samples = bind_samples(surface, found.sites.faces, found.sites.barycentric, ids);
  Report& report = samples.report;
  static_cast<Quality&>(report) = measure(domain, found.energy, found.sites, samples.normals);
  report.evaluations = found.evaluations;
  report.iterations = found.iterations;
  report.converged = found.converged;
  report.energies = std::move(found.energies);
  return samples;
}

void measure_slide(Report& report, std::span<const Vec3> now, std::span<const Vec3> before) {
  std::vector<double> slides;
  for (std::size_t k = 0; k < std::min(now.size(), before.size()); ++k)
    slides.push_back((now[k] - before[k]).norm() / report.spacing);
  if (slides.empty()) return;
  report.slide_mean =
      std::accumulate(slides.begin(), slides.end(), 0.0) / static_cast<double>(slides.size());
  std::sort(slides.begin(), slides.end());
  report.slide_median = slides[slides.size() / 2];
  report.slide_max = slides.back();
}

Report analyze(const Surface& surface, const Samples& samples, double capacity_weight, Cells cells,
               Context* context) {
  if (context) context->check();
  check_samples(surface, samples);
  const Sites sites{samples.positions, samples.faces, samples.barycentric};
  // The domain is that of an optimization, so that both report the same values.
  const SurfaceDomain domain(surface, cells, std::nullopt, EmptyFaces::kLeft);
  Report report;
  Stretch evaluating(context, 0.0, kEvaluated);
  const Energy energy = evaluate_energy(domain, sites, capacity_weight, evaluating.context());
  static_cast<Quality&>(report) = measure(domain, energy, sites, samples.normals);
  report.evaluations = 1;
  if (context) context->advance(1.0);
  return report;
}

}  // namespace dapple
