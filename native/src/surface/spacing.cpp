// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/limits.hpp>
#include <dapple/spacing.hpp>
#include <numbers>
#include <string>

#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// Of faces that have an area.
double largest_density(const OrderedSurface& surface) {
  double largest = 0.0;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const auto face = static_cast<OrderedFace>(f);
    if (!surface.geometry(face).normal.isZero(0.0))
      largest = std::max(largest, surface.densities(face).maxCoeff());
  }
  return largest;
}

}  // namespace

std::size_t count_at_spacing(const Surface& surface, double spacing) {
  check_positive("spacing", spacing);
  const double area = surface.mass() / largest_density(surface.ordered());
  const double samples = std::round(2.0 * area / (std::numbers::sqrt3 * spacing * spacing));
  if (!(samples <= static_cast<double>(kMostSamples)))
    throw ArgumentError("spacing is " + number(spacing) + ": the surface would have " +
                        number(samples) + " samples, at most " + std::to_string(kMostSamples) +
                        " are possible");
  return std::max<std::size_t>(static_cast<std::size_t>(samples), 1);
}

}  // namespace dapple
