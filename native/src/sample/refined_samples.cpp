// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/refined_samples.hpp>

#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "density/piece_finder.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

/// The samples on other faces, with all other data unchanged.
Samples rebound(const Surface& surface, std::span<const std::int32_t> faces,
                std::span<const Vec3> barycentric, const Samples& samples) {
  Samples result = bind_samples(surface, faces, barycentric, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

}  // namespace

Samples to_original(const Refined& refined, const Samples& samples) {
  check_binding("samples", refined.surface, samples.faces, samples.barycentric);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    check_at(k);
    const auto fine = static_cast<std::size_t>(samples.faces[k]);
    faces.push_back(refined.parents[fine]);
    weights.push_back(combined(refined.barycentric[fine], samples.barycentric[k]));
  }
  return rebound(refined.original, faces, weights, samples);
}

Samples from_original(const Refined& refined, const Samples& samples) {
  check_binding("samples", refined.original, samples.faces, samples.barycentric);
  const PieceFinder finder(refined);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    check_at(k);
    const auto [face, inside] = finder.find(samples.faces[k], samples.barycentric[k]);
    faces.push_back(face);
    weights.push_back(inside);
  }
  return rebound(refined.surface, faces, weights, samples);
}

}  // namespace dapple
