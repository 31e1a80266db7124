// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/lead_to_density.hpp"

#include "surface/ordered_surface.hpp"

namespace dapple {

bool has_density(const Surface& surface, std::int32_t face) {
  const OrderedSurface& mesh = surface.ordered();
  return mesh.geometry(mesh.ordered_face(face)).moments.capacity > 0.0;
}

void lead_to_density(const Surface& surface, const Domain& domain, Sites& sites,
                     const std::vector<bool>& fixed) {
  if (surface.uniform()) return;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if ((!fixed.empty() && fixed[k]) || has_density(surface, sites.faces[k])) continue;
    const Sites found = domain.project(std::span(sites.positions).subspan(k, 1), {});
    sites.positions[k] = found.positions[0];
    sites.faces[k] = found.faces[0];
    sites.barycentric[k] = found.barycentric[0];
  }
}

}  // namespace dapple
