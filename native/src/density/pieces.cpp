// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/pieces.hpp"

#include <numeric>

#include "base/progress.hpp"
#include "base/vectors.hpp"
#include "surface/corner_normals.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

std::vector<std::int32_t> welded_vertices(const Surface& surface) {
  const std::vector<Face> faces = surface.faces(), welded = surface.welded_faces();
  std::vector<std::int32_t> result(surface.vertex_count());
  std::iota(result.begin(), result.end(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(faces[f][k])] = welded[f][k];
  return result;
}

std::vector<double> density_without(const Surface& surface, std::span<const std::uint8_t> taken) {
  const OrderedSurface& mesh = surface.ordered();
  std::vector<double> density;
  density.reserve(3 * taken.size());
  bool left = false;
  for (std::size_t f = 0; f < taken.size(); ++f) {
    const OrderedFace face = mesh.ordered_face(static_cast<std::int32_t>(f));
    const Vec3 values = taken[f] ? Vec3(Vec3::Zero()) : mesh.densities(face);
    density.insert(density.end(), values.begin(), values.end());
    left = left || (!taken[f] && mesh.geometry(face).moments.capacity > 0.0);
  }
  return left ? density : std::vector<double>();
}

std::vector<std::int32_t> carried_bodies(const Surface& surface,
                                         std::span<const std::int32_t> parents) {
  const OrderedSurface& mesh = surface.ordered();
  std::vector<std::int32_t> result;
  if (mesh.connectivity().body.empty()) return result;
  result.reserve(parents.size());
  for (const std::int32_t parent : parents) result.push_back(mesh.body(mesh.ordered_face(parent)));
  return result;
}

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
  if (!surface.has_normals()) return {};
  check_context(context);
  const OrderedSurface& mesh = surface.ordered();
  const CornerNormals at_corners(mesh, refined.parents);
  std::vector<Vec3> result(3 * refined.parents.size());
  for_each_vector(result.size(), [&](std::size_t k) {
    const OrderedFace parent = mesh.ordered_face(refined.parents[k / 3]);
    result[k] = at_corners.between(parent, refined.barycentric[k / 3][k % 3]);
  });
  return result;
}

}  // namespace dapple
