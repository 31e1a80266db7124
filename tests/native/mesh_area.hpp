// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <vector>

namespace dapple::test {

/// The sum of the areas of triangles.
inline double area_of(const std::vector<Vec3>& vertices, const std::vector<Face>& faces) {
  double sum = 0.0;
  for (const auto& [a, b, c] : faces) {
    const Vec3& p = vertices[static_cast<std::size_t>(a)];
    sum += 0.5 * (vertices[static_cast<std::size_t>(b)] - p)
                     .cross(vertices[static_cast<std::size_t>(c)] - p)
                     .norm();
  }
  return sum;
}

}  // namespace dapple::test
