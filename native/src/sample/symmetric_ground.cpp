// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/symmetric_ground.hpp"

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/projector.hpp>

#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kRounding = 1e-9;  // of the surface's size
constexpr double kFaces = 2.0;      // inside of faces the error is larger than at vertices
// Densities are read this far inside of faces, because they may jump at edges; a share of the way
// to the other corners.
constexpr double kInside = 1e-3;
constexpr double kEqual = 1e-6;  // of the largest density: a difference that is rounding

/// Per vertex, whether a face with density has it.
std::vector<bool> used_vertices(const Surface& surface) {
  const OrderedSurface& ordered = surface.ordered();
  const std::vector<Face> faces = surface.faces();
  std::vector<bool> used(surface.vertex_count(), false);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const OrderedFace face = ordered.ordered_face(static_cast<std::int32_t>(f));
    if (!ordered.counts(face) || !(ordered.geometry(face).moments.capacity > 0.0)) continue;
    for (const std::int32_t v : faces[f]) used[static_cast<std::size_t>(v)] = true;
  }
  return used;
}

double check_symmetric(const Surface& surface, const Projector& projector, const Mirror& mirror,
                       double relative, const Context* context) {
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<bool> used = used_vertices(surface);
  std::vector<std::size_t> indices;
  std::vector<Vec3> images;
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (!used[v]) continue;
    indices.push_back(v);
    images.push_back(mirror.reflected(vertices[v]));
    box.extend(vertices[v]);
  }
  const double size = box.diagonal().stableNorm(), rounding = kRounding * size;
  check_finite("mirrored vertices", images);
  const Projection found = projector.project(images, {}, context);
  double worst = 0.0;
  for (std::size_t k = 0; k < images.size(); ++k) {
    worst = std::max(worst, found.distances[k]);
    if (!(found.distances[k] <= relative * size + rounding))
      throw ArgumentError("surface is not symmetric: the mirror image of " +
                          entry("vertices", indices[k]) + " is " + number(found.distances[k]) +
                          " from the surface, more than max_mirror_error allows, " +
                          number(relative * size));
  }
  return kFaces * worst + rounding;
}

double density_at(const OrderedSurface& ordered, std::int32_t face, const Vec3& weights) {
  return std::max(ordered.densities(ordered.ordered_face(face)).dot(weights), 0.0);
}

/// Per corner of the faces, the density just inside, and that at its image.
struct Densities {
  std::vector<double> here, there;
};

Densities densities(const Surface& surface, const Projector& projector, const Mirror& mirror,
                    double farthest, const Context* context) {
  const OrderedSurface& ordered = surface.ordered();
  Densities result;
  std::vector<Vec3> images;
  for (std::size_t k = 0; k < 3 * surface.face_count(); ++k) {
    const auto face = static_cast<std::int32_t>(k / 3);
    Vec3 weights = Vec3::Constant(kInside);
    weights[static_cast<Eigen::Index>(k % 3)] = 1.0 - 2.0 * kInside;
    result.here.push_back(density_at(ordered, face, weights));
    images.push_back(mirror.reflected(surface.point(face, weights)));
  }
  const Projection found = projector.project(images, {}, context);
  for (std::size_t k = 0; k < images.size(); ++k)
    result.there.push_back(found.distances[k] <= farthest
                               ? density_at(ordered, found.faces[k], found.barycentric[k])
                               : 0.0);
  return result;
}

}  // namespace

SymmetricGround symmetric_ground(const Surface& surface, const Mirror& mirror, double most,
                                 const Context* context) {
  const Projector projector(surface, /*support_only=*/false, context);
  const double farthest = check_symmetric(surface, projector, mirror, most, context);
  if (surface.uniform()) return {surface, farthest};
  Densities found = densities(surface, projector, mirror, farthest, context);
  const double largest = *std::ranges::max_element(found.here);
  double difference = 0.0;
  for (std::size_t k = 0; k < found.here.size(); ++k)
    difference = std::max(difference, std::abs(found.here[k] - found.there[k]));
  if (difference <= kEqual * largest) return {surface, farthest};
  for (std::size_t k = 0; k < found.here.size(); ++k)
    found.here[k] = 0.5 * found.here[k] + 0.5 * found.there[k];
  return {surface.with_density({DensityAt::kCorners, found.here}), farthest};
}

}  // namespace dapple
