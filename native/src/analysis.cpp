// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/analysis.hpp>
#include <limits>
#include <numbers>

namespace dapple {
namespace {

double nearest_touching(const RestrictedVoronoi& diagram, std::size_t i) {
  double squared = std::numeric_limits<double>::infinity();
  for (const CellBoundary& side : diagram.boundary(i))
    squared = std::min(squared, side.offset.squaredNorm());
  return std::sqrt(squared);
}

double spread(const RestrictedVoronoi& diagram, double mean) {
  double sum = 0.0;
  for (const Moments& cell : diagram.cells) sum += (cell.capacity - mean) * (cell.capacity - mean);
  return std::sqrt(sum / static_cast<double>(diagram.cells.size())) / mean;
}

}  // namespace

Evenness measure_evenness(const RestrictedVoronoi& diagram) {
  Evenness result;
  if (diagram.cells.size() == 0) return result;
  double capacity = 0.0;
  for (const Moments& cell : diagram.cells) capacity += cell.capacity;
  capacity /= static_cast<double>(diagram.cells.size());
  result.capacity_spread = spread(diagram, capacity);
  double sum = 0.0;
  std::size_t counted = 0;
  result.alpha_min = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) {
    const Moments& cell = diagram.cells[i];
    // An empty cell belongs to a site that coincides with another: nothing lies between them.
    const double area = cell.capacity > 0.0 ? capacity * cell.area / cell.capacity : 0.0;
    const double alpha =
        area > 0.0 ? nearest_touching(diagram, i) / std::sqrt(2.0 * area / std::numbers::sqrt3)
                   : 0.0;
    if (!std::isfinite(alpha)) continue;  // no neighbour: alone on its component
    result.alpha_min = std::min(result.alpha_min, alpha);
    sum += alpha;
    ++counted;
  }
  result.alpha_mean = counted > 0 ? sum / static_cast<double>(counted) : 0.0;
  if (counted == 0) result.alpha_min = 0.0;
  return result;
}

}  // namespace dapple
