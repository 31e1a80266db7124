// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/carried.hpp"

#include "base/progress.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

std::vector<double> carried_density(const Surface& surface, const Refined& refined,
                                    const Context* context) {
  std::vector<double> values;
  if (surface.uniform()) return values;
  values.reserve(3 * refined.parents.size());
  for (std::size_t f = 0; f < refined.parents.size(); ++f) {
    check_at(context, f);
    for (const Vec3& weights : refined.barycentric[f])
      values.push_back(weights.dot(
          surface.ordered().densities(surface.ordered().ordered_face(refined.parents[f]))));
  }
  return values;
}

std::vector<Vec3> carried_normals(const Surface& surface, const Refined& refined,
                                  const Context* context) {
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  faces.reserve(3 * refined.parents.size());
  weights.reserve(faces.capacity());
  for (std::size_t f = 0; f < refined.parents.size(); ++f) {
    check_at(context, f);
    for (const Vec3& corner : refined.barycentric[f]) {
      faces.push_back(refined.parents[f]);
      weights.push_back(corner);
    }
  }
  return surface.normals(faces, weights);
}

}  // namespace dapple
