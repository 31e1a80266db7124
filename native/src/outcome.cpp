// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome.hpp"

namespace dapple {

Samples to_samples(const Surface& surface, OptimizerResult&& found,
                   std::span<const std::int32_t> ids, std::span<const std::int32_t> classes) {
  Samples samples = bind_samples(surface, found.sites.faces, found.sites.barycentric, ids, classes);
  samples.report.evenness = measure_evenness(found.energy.diagram);
  samples.report.energy = found.energy.normalised;
  samples.report.evaluations = found.evaluations;
  samples.report.iterations = found.iterations;
  samples.report.converged = found.converged;
  samples.report.energies = std::move(found.energies);
  return samples;
}

}  // namespace dapple
