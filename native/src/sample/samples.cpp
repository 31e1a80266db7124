// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/samples.hpp>
#include <numeric>

#include "base/validate.hpp"
#include "base/vectors.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kRounding = 1e-14;  // rounding error of weights that are normalized already

/// Barycentric coordinates without negative values and with sum 1. Coordinates that satisfy this
/// already are unchanged, so that binding again changes nothing.
Vec3 normalized(const Vec3& row) {
  const Vec3 weights = row.cwiseMax(0.0);
  const double sum = weights.sum();
  return std::abs(sum - 1.0) <= kRounding ? weights : Vec3(weights / sum);
}

void check_ids(std::span<const std::int32_t> ids) {
  const auto not_above = [](std::int32_t a, std::int32_t b) { return a >= b; };
  if (std::adjacent_find(ids.begin(), ids.end(), not_above) == ids.end()) return;  // increasing
  std::vector<std::int32_t> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
  if (twin != sorted.end())
    throw ArgumentError("ids contains " + std::to_string(*twin) + " twice: each must be unique");
}

}  // namespace

Samples bind_samples(const Surface& surface, std::span<const std::int32_t> faces,
                     std::span<const Vec3> barycentric, std::span<const std::int32_t> ids,
                     std::span<const std::int32_t> classes) {
  const std::size_t count = faces.size();
  check_count("the number of faces", count);
  check_binding("", surface, faces, barycentric);
  if (!ids.empty()) check_same_length("ids", ids.size(), "faces", count);
  if (!classes.empty()) check_same_length("classes", classes.size(), "faces", count);
  check_ids(ids);

  Samples samples;
  samples.faces.assign(faces.begin(), faces.end());
  samples.barycentric.assign(barycentric.begin(), barycentric.end());
  samples.positions.resize(count);
  surface.move_to_counted(samples.faces, samples.barycentric);
  for_each_vector(count, [&](std::size_t k) {
    samples.barycentric[k] = normalized(samples.barycentric[k]);
    samples.positions[k] = surface.point(samples.faces[k], samples.barycentric[k]);
  });
  samples.normals = surface.normals(samples.faces, samples.barycentric);
  samples.ids.assign(ids.begin(), ids.end());
  samples.classes.assign(classes.begin(), classes.end());
  samples.classes.resize(count, 0);
  if (ids.empty()) {
    samples.ids.resize(count);
    std::iota(samples.ids.begin(), samples.ids.end(), 0);
  }
  samples.report.count = count;
  samples.report.spacing = surface.spacing(count);
  return samples;
}

}  // namespace dapple
