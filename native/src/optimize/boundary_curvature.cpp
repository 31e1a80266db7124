// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/boundary_curvature.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dapple {
namespace {

constexpr double kDenser = 4.0;  // times the density of the cell: the most that a boundary has
constexpr double kInertia = 1.0 / 12.0;  // of a segment of length 1 around its middle

double mean_density(const Moments& cell) {
  return cell.capacity > 0.0 ? cell.mass / cell.capacity : 0.0;
}

Tangent turned(const Tangent& a) { return {-a.v, a.u}; }

}  // namespace

// On the bisector (x - x_i) . (x_j - x_i) = |x_j - x_i|^2 / 2, so that the flux holds the integral
// of phi / |x_j - x_i|, called weight, and with it the middle of the boundary.
BoundaryCurvature::Side BoundaryCurvature::side(const RestrictedVoronoi& diagram, std::size_t cell,
                                                const CellBoundary& boundary,
                                                const std::vector<TangentBasis>& bases,
                                                double factor) const {
  const std::size_t own = site(cell), other = site(static_cast<std::size_t>(boundary.neighbor));
  const auto number = static_cast<std::int32_t>(other);
  const double squared = boundary.offset.squaredNorm();
  const double weight = 2.0 * boundary.flux.dot(boundary.offset) / squared;
  if (!(weight > 0.0) || !(boundary.length > 0.0)) return {number, {}, {}, {}, {}};
  const double density = std::min(weight * std::sqrt(squared) / boundary.length,
                                  kDenser * mean_density(diagram.cells[cell]));
  const double root = std::sqrt(2.0 * factor * density * weight);
  const double width = root * boundary.length * std::sqrt(kInertia / squared);
  const Vec3 middle = boundary.flux / weight;
  return {number, to_tangent(bases[own], middle, root),
          to_tangent(bases[other], middle - boundary.offset, root),
          turned(to_tangent(bases[own], boundary.offset, width)),
          turned(to_tangent(bases[other], boundary.offset, width))};
}

void BoundaryCurvature::update(const RestrictedVoronoi& diagram,
                               std::span<const std::int32_t> members,
                               const std::vector<TangentBasis>& bases, double factor) {
  members_ = members;
  starts_.assign(diagram.cells.size() + 1, 0);
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    starts_[i + 1] = diagram.boundary(i).size();
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  sides_.resize(starts_.back());
  for_each_vector(diagram.cells.size(), [&](std::size_t i) {
    std::size_t next = starts_[i];
    for (const CellBoundary& boundary : diagram.boundary(i))
      sides_[next++] = side(diagram, i, boundary, bases, factor);
  });
}

Tangent BoundaryCurvature::product(const TangentVectors& v, std::size_t cell, double share) const {
  const Tangent& own = v[site(cell)];
  Tangent sum;
  for (const Side& side : sides(cell)) {
    const Tangent& other = v[static_cast<std::size_t>(side.other)];
    sum += (side.middle.dot(own) - side.others_middle.dot(other)) * side.middle;
    sum += (side.along.dot(own) - side.others_along.dot(other)) * side.along;
  }
  return share * sum;
}

TangentBlock BoundaryCurvature::block(std::size_t cell) const {
  TangentBlock sum;
  for (const Side& side : sides(cell)) {
    sum.add_square(side.middle);
    sum.add_square(side.along);
  }
  return sum;
}

}  // namespace dapple
