// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/neighbours.hpp>
#include <dapple/refine.hpp>
#include <limits>

#include "validate.hpp"

namespace dapple {
namespace {

/// Finds the piece of a face that holds a point of it: pieces are asked in the order of their
/// middles' distances, in barycentric coordinates.
class PieceFinder {
 public:
  explicit PieceFinder(const Refined& refined)
      : refined_(refined), middles_(middles_of(refined)), tree_(middles_) {}

  /// The piece, and the point's weights in it.
  [[nodiscard]] std::pair<std::int32_t, Vec3> find(std::int32_t parent, const Vec3& weights) const {
    std::pair<std::int32_t, Vec3> best{0, Vec3::Zero()};
    double most = -std::numeric_limits<double>::infinity();
    std::vector<Neighbour> near;
    for (std::size_t count = 8; most < -kOnEdge; count *= 4) {
      tree_.nearest(place(parent, weights), count, near);
      for (const Neighbour& one : near) {
        if (refined_.parents[static_cast<std::size_t>(one.index)] != parent) continue;
        const Vec3 inside =
            weights_in(refined_.barycentric[static_cast<std::size_t>(one.index)], weights);
        if (inside.minCoeff() <= most) continue;
        most = inside.minCoeff();
        best = {one.index, inside};
      }
      if (near.size() == middles_.size()) break;
    }
    const Vec3 clipped = best.second.cwiseMax(0.0);
    return {best.first, clipped / clipped.sum()};
  }

 private:
  static constexpr double kOnEdge = 1e-12;

  // Faces lie 4 apart, farther than any two points of one.
  static Vec3 place(std::int32_t parent, const Vec3& weights) {
    return {weights[1], weights[2], 4.0 * parent};
  }

  static std::vector<Vec3> middles_of(const Refined& refined) {
    std::vector<Vec3> middles;
    for (std::size_t f = 0; f < refined.parents.size(); ++f) {
      const auto& [a, b, c] = refined.barycentric[f];
      middles.push_back(place(refined.parents[f], (a + b + c) / 3.0));
    }
    return middles;
  }

  // Weights of a point, given by its weights in the parent, in one of its pieces.
  static Vec3 weights_in(const std::array<Vec3, 3>& corners, const Vec3& weights) {
    const auto doubled = [](const Vec3& a, const Vec3& b, const Vec3& c) {
      return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
    };
    const auto& [a, b, c] = corners;
    return Vec3(doubled(weights, b, c), doubled(a, weights, c), doubled(a, b, weights)) /
           doubled(a, b, c);
  }

  const Refined& refined_;
  std::vector<Vec3> middles_;
  Neighbours tree_;
};

Vec3 combined(const std::array<Vec3, 3>& corners, const Vec3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

}  // namespace

Samples Refined::to_original(const Samples& samples) const {
  check_face_indices("faces", samples.faces, surface);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto fine = static_cast<std::size_t>(samples.faces[k]);
    faces.push_back(parents[fine]);
    weights.push_back(combined(barycentric[fine], samples.barycentric[k]));
  }
  Samples result = bind_samples(original, faces, weights, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

Samples Refined::from_original(const Samples& samples) const {
  check_face_indices("faces", samples.faces, original);
  const PieceFinder finder(*this);
  std::vector<std::int32_t> faces;
  std::vector<Vec3> weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto [face, inside] = finder.find(samples.faces[k], samples.barycentric[k]);
    faces.push_back(face);
    weights.push_back(inside);
  }
  Samples result = bind_samples(surface, faces, weights, samples.ids, samples.classes);
  result.fade = samples.fade;
  result.report = samples.report;
  return result;
}

std::vector<Vec3> Refined::vertices(std::span<const Vec3> coarse) const {
  check_same_length("vertices", coarse.size(), "the surface", original.vertex_count());
  std::vector<Vec3> result(coarse.begin(), coarse.end());
  result.reserve(coarse.size() + ends.size());
  for (const auto& [a, b] : ends)
    result.emplace_back(
        0.5 * (result[static_cast<std::size_t>(a)] + result[static_cast<std::size_t>(b)]));
  return result;
}

Refined Refined::deformed(std::span<const Vec3> coarse) const {
  Refined result = *this;
  result.original = original.deformed(coarse);
  result.surface = surface.deformed(vertices(coarse));
  return result;
}

Refined Refined::then(const Refined& finer) const {
  check_same_length("faces of finer's original", finer.original.face_count(), "the surface",
                    surface.face_count());
  Refined result{original, finer.surface, {}, {}, ends, resolved && finer.resolved};
  result.ends.insert(result.ends.end(), finer.ends.begin(), finer.ends.end());
  for (std::size_t f = 0; f < finer.parents.size(); ++f) {
    const auto middle = static_cast<std::size_t>(finer.parents[f]);
    result.parents.push_back(parents[middle]);
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = combined(barycentric[middle], finer.barycentric[f][k]);
    result.barycentric.push_back(corners);
  }
  return result;
}

}  // namespace dapple
