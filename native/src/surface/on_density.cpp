// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/on_density.hpp"

#include <atomic>

#include "base/parallel.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kInward = 1e-6;  // share of the distance to the corner with the largest density
constexpr std::size_t kGrain = 1024;  // points
constexpr std::size_t kFaceGrain = 4096;

}  // namespace

bool has_density(const Surface& surface, OrderedFace face) {
  return surface.ordered().geometry(face).moments.capacity > 0.0;
}

bool has_gaps(const Surface& surface) {
  if (surface.uniform()) return false;
  const OrderedSurface& mesh = surface.ordered();
  std::atomic<bool> found = false;
  parallel_chunks(mesh.face_count(), kFaceGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end && !found; ++f)
      if (mesh.geometry(nth_face(f)).moments.area > 0.0 && !has_density(surface, nth_face(f)))
        found = true;
  });
  return found;
}

bool is_on_density(const Surface& surface, std::int32_t face, const Vec3& weights) {
  const OrderedFace ordered = surface.ordered().ordered_face(face);
  return has_density(surface, ordered) && weights.dot(surface.ordered().densities(ordered)) > 0.0;
}

void move_off_zeros(const Surface& surface, std::span<const std::int32_t> faces,
                    std::span<Vec3> weights, std::span<Vec3> positions) {
  if (surface.uniform()) return;
  parallel_chunks(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 densities = surface.ordered().densities(surface.ordered().ordered_face(faces[k]));
      if (weights[k].dot(densities) > 0.0) continue;
      Eigen::Index densest = 0;
      densities.maxCoeff(&densest);
      weights[k] += kInward * (Vec3::Unit(densest) - weights[k]);
      positions[k] = surface.point(faces[k], weights[k]);
    }
  });
}

}  // namespace dapple
