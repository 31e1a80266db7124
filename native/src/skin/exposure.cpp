// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/exposure.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "skin/sky.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

std::vector<double> exposure(const Surface& surface, std::span<const std::int32_t> faces,
                             std::span<const Vec3> barycentric, Context* context) {
  check_same_length("barycentric", barycentric.size(), "faces", faces.size());
  check_face_indices("faces", faces, surface.face_count());
  const Sky sky(surface, context);
  const OrderedSurface& mesh = surface.ordered();
  std::vector<double> result(faces.size(), 0.0);
  Tally tally(context, faces.size());
  parallel_chunks(faces.size(), 64, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t k = begin; k < end; ++k) {
      const OrderedFace face = mesh.ordered_face(faces[k]);
      if (!mesh.counts(face) || !(mesh.geometry(face).moments.area > 0.0)) continue;
      const Vec3 place = surface.point(faces[k], barycentric[k]);
      if (!sky.is_covered(place, faces[k]))
        result[k] = sky.exposure(place, mesh.geometry(face).normal, faces[k]);
    }
    tally.add(end - begin);
  });
  if (context) context->advance(1.0);
  return result;
}

std::vector<double> exposure(const Surface& surface, Context* context) {
  std::vector<std::int32_t> faces(surface.face_count());
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<std::int32_t>(f);
  const std::vector<Vec3> centers(faces.size(), Vec3::Constant(1.0 / 3.0));
  return exposure(surface, faces, centers, context);
}

}  // namespace dapple
