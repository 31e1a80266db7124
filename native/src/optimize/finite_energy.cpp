// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/finite_energy.hpp"

#include <cmath>

#include "base/validate.hpp"

namespace dapple {

void check_finite(const Energy& energy, std::span<const std::int32_t> members) {
  if (std::isfinite(energy.total)) return;
  const std::vector<Moments>& cells = energy.diagram.cells;
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (!std::isfinite(cells[k].second))
      throw SurfaceError(
          "the cell of " +
          entry("samples", members.empty() ? k : static_cast<std::size_t>(members[k])) +
          " reaches so far that squares of distances in it are not finite: vertices "
          "are too far apart");
  throw SurfaceError("vertices are so far apart that the energy is not finite");
}

void check_finite(const Objective& objective, const State& state) {
  for (std::size_t t = 0; t < state.parts.size(); ++t)
    check_finite(state.parts[t].energy, objective.terms[t].members);
}

}  // namespace dapple
