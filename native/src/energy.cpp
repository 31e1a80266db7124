// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/energy.hpp>

#include "validate.hpp"

namespace dapple {
namespace {

void check_sites(const Surface& surface, const Sites& sites) {
  check_same_length("faces", sites.faces.size(), "positions", sites.size());
  check_finite("positions", sites.positions);
  check_face_indices("faces", sites.faces, surface);
}

/// dE/dx_i = 2 m_i (x_i - c_i) + 2 lambda sum_j (|V_i| - |V_j|) a_ij (paper, equations 4, 5 and
/// Theorem 2).
std::vector<Vec3> gradient(const RestrictedVoronoi& diagram, double capacity_weight) {
  std::vector<Vec3> result(diagram.cells.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Moments& cell = diagram.cells[i];
    Vec3 capacity = Vec3::Zero();
    for (const CellBoundary& side : diagram.boundary(i))
      capacity +=
          (cell.capacity - diagram.cells[static_cast<std::size_t>(side.neighbour)].capacity) *
          side.flux;
    result[i] = -2.0 * cell.first + 2.0 * capacity_weight * capacity;
  }
  return result;
}

}  // namespace

Energy evaluate_energy(const Surface& surface, const Sites& sites, double capacity_weight,
                       const Context* context) {
  check_sites(surface, sites);
  check_at_least("capacity_weight", capacity_weight, 0.0);
  Energy energy;
  energy.diagram = restricted_voronoi(surface, sites, context);
  for (const Moments& cell : energy.diagram.cells) {
    energy.cvt += cell.second;
    energy.capacity_term += cell.capacity * cell.capacity;
  }
  energy.total = energy.cvt + capacity_weight * energy.capacity_term;
  const double mass = surface.mass();
  energy.normalised =
      static_cast<double>(sites.size()) / mass * energy.total / mass - capacity_weight;
  energy.gradient = gradient(energy.diagram, capacity_weight);
  return energy;
}

}  // namespace dapple
