// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/energy.hpp"

#include <cmath>

#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "base/vectors.hpp"
#include "voronoi/unit_voronoi.hpp"

namespace dapple {
namespace {

constexpr double kWhole = 1e-6;  // relative rounding error of the total

/// dE/dx_i = 2 m_i (x_i - c_i) + 2 lambda sum_j (|V_i| - |V_j|) a_ij (paper, equations 4, 5 and
/// Theorem 2).
void find_gradient(const RestrictedVoronoi& diagram, double capacity_weight,
                   std::vector<Vec3>& result) {
  result.resize(diagram.cells.size());
  for_each_vector(result.size(), [&](std::size_t i) {
    const Moments& cell = diagram.cells[i];
    Vec3 capacity = Vec3::Zero();
    for (const CellBoundary& side : diagram.boundary(i))
      capacity +=
          (cell.capacity - diagram.cells[static_cast<std::size_t>(side.neighbor)].capacity) *
          side.flux;
    result[i] = -2.0 * cell.first + 2.0 * capacity_weight * capacity;
  });
}

Energy without_unit(Energy energy, double density_unit) {
  const double once = 1.0 / density_unit;
  remove_unit(energy.diagram, density_unit);
  for (double* sum : {&energy.total, &energy.cvt, &energy.capacity_term}) *sum = *sum * once * once;
  for (Vec3& g : energy.gradient) g = g * once * once;
  return energy;
}

}  // namespace

Energy evaluate_energy(const Surface& surface, const Sites& sites, double capacity_weight,
                       Cells cells, Context* context) {
  const SurfaceDomain domain(surface, cells);
  return without_unit(evaluate_energy(domain, sites, capacity_weight, context),
                      domain.density_unit());
}

Energy evaluate_energy(const Domain& domain, const Sites& sites, double capacity_weight,
                       Context* context) {
  Energy energy;
  update_energy(energy, domain, sites, capacity_weight, context);
  check_finite_energy(energy.total, energy.diagram.cells);
  return energy;
}

void update_energy(Energy& energy, const Domain& domain, const Sites& sites, double capacity_weight,
                   Context* context) {
  domain.check(sites);
  check_at_least("capacity_weight", capacity_weight, 0.0);
  in_stage(context, Stage::kCells, [&] { domain.update_cells(energy.diagram, sites, 0, context); });
  sum_up(energy, domain.capacity(), capacity_weight);
}

void sum_up(Energy& energy, double capacity, double capacity_weight) {
  const std::vector<Moments>& cells = energy.diagram.cells;
  energy.cvt =
      parallel_sum(cells.size(), kVectorGrain, [&](std::size_t k) { return cells[k].second; });
  energy.capacity_term = parallel_sum(cells.size(), kVectorGrain, [&](std::size_t k) {
    return cells[k].capacity * cells[k].capacity;
  });
  energy.total = energy.cvt + capacity_weight * energy.capacity_term;
  const auto count = static_cast<double>(energy.diagram.cells.size());
  const double owned = capacity * owned_share(energy.diagram, capacity);
  energy.normalized = count / owned * energy.total / owned - capacity_weight;
  find_gradient(energy.diagram, capacity_weight, energy.gradient);
}

double owned_share(const RestrictedVoronoi& diagram, double capacity) {
  const std::vector<Moments>& cells = diagram.cells;
  const double owned =
      parallel_sum(cells.size(), kVectorGrain, [&](std::size_t k) { return cells[k].capacity; });
  return owned > 0.0 && owned < (1.0 - kWhole) * capacity ? owned / capacity : 1.0;
}

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
