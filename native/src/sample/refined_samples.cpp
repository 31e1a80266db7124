// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/refined_samples.hpp>

#include "density/piece_finder.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

Vec3 combined(const std::array<Vec3, 3>& corners, const Vec3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

}  // namespace

Samples to_original(const Refined& refined, const Samples& samples) {
  check_binding("samples", refined.surface, samples.faces, samples.barycentric);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto fine = static_cast<std::size_t>(samples.faces[k]);
    faces.push_back(refined.parents[fine]);
    weights.push_back(combined(refined.barycentric[fine], samples.barycentric[k]));
  }
  Samples result = bind_samples(refined.original, faces, weights, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

Samples from_original(const Refined& refined, const Samples& samples) {
  check_binding("samples", refined.original, samples.faces, samples.barycentric);
  const PieceFinder finder(refined);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto [face, inside] = finder.find(samples.faces[k], samples.barycentric[k]);
    faces.push_back(face);
    weights.push_back(inside);
  }
  Samples result = bind_samples(refined.surface, faces, weights, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

}  // namespace dapple
