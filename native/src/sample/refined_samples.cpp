// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/refined_samples.hpp>

#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "base/triangle.hpp"
#include "density/piece_finder.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kAcute = 0.1;       // cosine of the angle between normals
constexpr double kMostInset = 0.25;  // of the height of a face
constexpr double kFarthest = 1.5;    // times the distance: the longest way that a sample moves

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

/// Moves samples away from the outer edges of faces, and from the ends of such edges.
class Inset {
 public:
  /// \param distance by which, or as far as a face allows; 0: not at all
  Inset(const OrderedSurface& mesh, double distance) : mesh_(mesh), distance_(distance) {
    if (distance <= 0.0) return;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      check_at(f);
      if (!(mesh.geometry(nth_face(f)).moments.capacity > 0.0)) continue;
      const Face corners = mesh.welded_corners(nth_face(f));
      for (std::size_t k = 0; k < 3; ++k)
        if (is_outer(mesh, half_edge(nth_face(f), static_cast<std::int32_t>(k)))) {
          ends_.push_back(corners[k]);
          ends_.push_back(corners[(k + 1) % 3]);
        }
    }
    sort_unique(ends_);
  }

  [[nodiscard]] Vec3 weights(std::int32_t face, Vec3 weights) const {
    if (distance_ <= 0.0) return weights;
    const OrderedFace ordered = mesh_.ordered_face(face);
    const Vec3 before = weights;
    for (std::int32_t k = 0; k < 3; ++k)
      if (is_outer(mesh_, half_edge(ordered, k))) leave_edge(ordered, k, weights);
    for (std::int32_t k = 0; k < 3; ++k)
      if (is_end(mesh_.welded_corners(ordered)[as_index(k)])) leave_corner(ordered, k, weights);
    // In a needle the way to another corner is far longer than the distance to the edge.
    const double way = (mesh_.point(ordered, weights) - mesh_.point(ordered, before)).norm();
    return way <= kFarthest * distance_
               ? weights
               : Vec3(between(before, weights, kFarthest * distance_ / way));
  }

 private:
  [[nodiscard]] bool is_end(std::int32_t vertex) const {
    return std::binary_search(ends_.begin(), ends_.end(), vertex);
  }

  /// The distance as a share of the height over an edge of the face.
  [[nodiscard]] double share_over(OrderedFace face, std::int32_t edge) const {
    const Face corners = mesh_.corners(face);
    const Vec3& from = mesh_.vertex(corners[as_index(edge)]);
    const double length = (mesh_.vertex(corners[as_index((edge + 1) % 3)]) - from).norm();
    return std::min(kMostInset, distance_ * length / (2.0 * mesh_.geometry(face).moments.area));
  }

  void leave_edge(OrderedFace face, std::int32_t edge, Vec3& weights) const {
    const double least = share_over(face, edge);
    const Eigen::Index opposite = (edge + 2) % 3;
    if (weights[opposite] >= least) return;
    const double others = 1.0 - weights[opposite];
    weights *= others > 0.0 ? (1.0 - least) / others : 1.0;
    weights[opposite] = least;
  }

  void leave_corner(OrderedFace face, std::int32_t corner, Vec3& weights) const {
    const double least = share_over(face, (corner + 1) % 3);
    const double others = 1.0 - weights[corner];
    if (others >= least) return;
    Vec3 away = weights;
    away[corner] = 0.0;
    if (others <= 0.0) away = Vec3::Ones() - Vec3::Unit(corner);
    weights = least * away / away.sum();
    weights[corner] = 1.0 - least;
  }

  const OrderedSurface& mesh_;
  double distance_;
  std::vector<std::int32_t> ends_;  // welded vertices, sorted
};

}  // namespace

Samples to_original(const Refined& refined, const Samples& samples) {
  check_binding("samples", refined.surface, samples.faces, samples.barycentric);
  const Inset inset(refined.surface.ordered(), refined.inset);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    check_at(k);
    const auto fine = static_cast<std::size_t>(samples.faces[k]);
    faces.push_back(refined.parents[fine]);
    weights.push_back(combined(refined.barycentric[fine],
                               inset.weights(samples.faces[k], samples.barycentric[k])));
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
