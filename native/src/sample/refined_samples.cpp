// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/refined_samples.hpp>

#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "density/piece_finder.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kAcute = 0.1;       // cosine of the angle between normals
constexpr double kMostInset = 0.25;  // of the height of a face

/// The samples on other faces, with all other data unchanged.
Samples rebound(const Surface& surface, std::span<const std::int32_t> faces,
                std::span<const Vec3> barycentric, const Samples& samples) {
  Samples result = bind_samples(surface, faces, barycentric, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

/// Whether a face beyond an edge has no density, or turns back at an acute angle: a place on the
/// edge itself is then seen from outside or not by rounding.
bool is_outer(const OrderedSurface& mesh, std::int32_t half_edge) {
  const Vec3& normal = mesh.geometry(face_of(half_edge)).normal;
  for (std::int32_t h = mesh.next_around(half_edge); h != half_edge; h = mesh.next_around(h)) {
    const FaceGeometry& beyond = mesh.geometry(face_of(h));
    if (!(beyond.moments.capacity > 0.0) || beyond.normal.dot(normal) < kAcute) return true;
  }
  return false;
}

/// The weights of a sample moved away from the edges of its face that are outer ones, by a
/// distance or as far as the face allows.
Vec3 inset_weights(const OrderedSurface& mesh, std::int32_t face, Vec3 weights, double distance) {
  const OrderedFace ordered = mesh.ordered_face(face);
  const Face corners = mesh.corners(ordered);
  const double doubled = 2.0 * mesh.geometry(ordered).moments.area;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!is_outer(mesh, half_edge(ordered, static_cast<std::int32_t>(k)))) continue;
    const auto opposite = static_cast<Eigen::Index>((k + 2) % 3);
    const double length = (mesh.vertex(corners[(k + 1) % 3]) - mesh.vertex(corners[k])).norm();
    const double least = std::min(kMostInset, distance * length / doubled);
    if (weights[opposite] >= least) continue;
    const double others = 1.0 - weights[opposite];
    weights *= others > 0.0 ? (1.0 - least) / others : 1.0;
    weights[opposite] = least;
  }
  return weights;
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
    const Vec3 inside = refined.inset > 0.0
                            ? inset_weights(refined.surface.ordered(), samples.faces[k],
                                            samples.barycentric[k], refined.inset)
                            : samples.barycentric[k];
    weights.push_back(combined(refined.barycentric[fine], inside));
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
