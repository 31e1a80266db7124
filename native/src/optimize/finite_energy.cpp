// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/finite_energy.hpp"

#include <cmath>

#include "base/validate.hpp"

namespace dapple {

void check_finite_energy(double energy, const std::vector<Moments>& cells,
                         std::span<const std::int32_t> members) {
  if (std::isfinite(energy)) return;
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (!std::isfinite(cells[k].second))
      throw SurfaceError(
          "the cell of " +
          entry("samples", members.empty() ? k : static_cast<std::size_t>(members[k])) +
          " reaches so far that squares of distances in it are not finite: vertices "
          "are too far apart");
  throw SurfaceError("vertices are so far apart that the energy is not finite");
}

}  // namespace dapple
