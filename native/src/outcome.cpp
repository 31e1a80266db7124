// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome.hpp"

#include <dapple/energy.hpp>

namespace dapple {
namespace {

/// Fill in all that the energy at the samples and its diagram tell.
void measure(const Surface& surface, const Energy& energy, const Sites& sites,
             std::span<const Vec3> normals, Report& report) {
  report.evenness = measure_evenness(energy.diagram);
  report.bond_order =
      bond_order(energy.diagram, normals, cells_on_border(surface, sites, energy.diagram));
  report.energy = energy.normalised;
}

}  // namespace

Samples to_samples(const Surface& surface, OptimizerResult&& found,
                   std::span<const std::int32_t> ids, std::span<const std::int32_t> classes) {
  Samples samples = bind_samples(surface, found.sites.faces, found.sites.barycentric, ids, classes);
  measure(surface, found.energy, found.sites, samples.normals, samples.report);
  samples.report.evaluations = found.evaluations;
  samples.report.iterations = found.iterations;
  samples.report.converged = found.converged;
  samples.report.energies = std::move(found.energies);
  return samples;
}

Report analyse(const Surface& surface, const Samples& samples, double capacity_weight,
               Cells cells) {
  const Sites sites{samples.positions, samples.faces, samples.barycentric};
  Report report;
  report.count = samples.size();
  report.spacing = surface.spacing(samples.size());
  report.evaluations = 1;
  measure(surface, evaluate_energy(surface, sites, capacity_weight, nullptr, cells), sites,
          samples.normals, report);
  return report;
}

}  // namespace dapple
