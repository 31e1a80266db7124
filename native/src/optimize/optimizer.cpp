// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/optimizer.hpp>

#include "base/validate.hpp"
#include "optimize/minimizer.hpp"

namespace dapple {

OptimizerResult optimize(const Domain& domain, const Sites& start, const OptimizerOptions& options,
                         Context* context) {
  check_finite("barycentric", start.barycentric);
  const Objective objective{.capacity_weight = options.capacity_weight,
                            .terms = {{.domain = &domain,
                                       .repulsion_radius = options.repulsion_radius,
                                       .repulsion_weight = options.repulsion_weight}}};
  Minimum found = minimize(objective, start, options, context);
  return {.sites = std::move(found.state.sites),
          .energy = std::move(found.state.parts[0].energy),
          .energies = std::move(found.energies),
          .evaluations = found.evaluations,
          .iterations = found.iterations,
          .converged = found.converged};
}

}  // namespace dapple
