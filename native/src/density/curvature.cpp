// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <dapple/curvature.hpp>
#include <numbers>
#include <numeric>

#include "base/elementary.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

using Mat3 = Eigen::Matrix3d;

constexpr double kAtBorder = 1e-6;  // weight of a face at a border, where normals are one-sided
// Shares of the progress of each step.
constexpr double kOriented = 1.0, kNormals = 1.0, kTensors = 5.0, kSmoothed = 6.0;
constexpr double kFound = 0.95;
constexpr double kKnown = 0.85;  // share of the progress of a density when the curvature is known
constexpr double kFlat = 1e-9;   // curvedness times size: smaller values are rounding errors

std::size_t as_size(std::int32_t k) { return static_cast<std::size_t>(k); }

/// A sign per ordered face; multiplied by their signs, the normals of neighbors point to the same
/// side.
std::vector<double> orient(const Surface& surface, const Context* context) {
  std::vector<double> signs(surface.face_count(), 0.0);
  std::vector<std::int32_t> pending;
  std::size_t seen = 0;
  const auto start_of = [&](std::int32_t h) {
    return surface.ordered().welded_corners(face_of(h))[as_size(h % 3)];
  };
  for (std::size_t first = 0; first < signs.size(); ++first) {
    if (signs[first] != 0.0) continue;
    signs[first] = 1.0;
    pending.push_back(static_cast<std::int32_t>(first));
    while (!pending.empty()) {
      check_at(context, seen++);
      const std::int32_t face = pending.back();
      pending.pop_back();
      for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h) {
        const std::int32_t g = surface.ordered().next_around(h);
        if (surface.ordered().next_around(g) != h || signs[as_size(g / 3)] != 0.0) continue;
        signs[as_size(g / 3)] = (start_of(g) == start_of(h) ? -1.0 : 1.0) * signs[as_size(face)];
        pending.push_back(g / 3);
      }
    }
  }
  return signs;
}

/// Sums of weighted tensors and of weights over the neighborhood of a vertex.
struct WeightedTensor {
  Mat3 sum = Mat3::Zero();
  double weight = 0.0;

  /// Add a part, rotated from its normal to the normal of this neighborhood.
  void add(const WeightedTensor& part, const Vec3& normal, const Vec3& ours, double scale = 1.0) {
    if (part.weight <= 0.0) return;
    const Mat3 turn = turning(normal, ours);
    sum += scale * (turn * part.sum * turn.transpose());
    weight += scale * part.weight;
  }

 private:
  /// The rotation between two normals. It is the identity if one of them is zero, as at a vertex
  /// whose faces' normals cancel.
  static Mat3 turning(const Vec3& from, const Vec3& to) {
    if (from.isZero(0.0) || to.isZero(0.0)) return Mat3::Identity();
    return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  }
};

/// Normals and curvature tensors in the surface's own order; welded vertices store them at the
/// lowest vertex.
class CurvatureField {
 public:
  CurvatureField(const Surface& surface, int smoothing, Context* context)
      : surface_(surface), context_(context), normals_(surface.vertex_count(), Vec3::Zero()) {
    const double all = kOriented + kNormals + kTensors + smoothing * (kNormals + kSmoothed);
    const auto did = [&](double share) {
      done_ += share / all;
      if (context) context->advance(done_);
    };
    const std::vector<double> signs = orient(surface, context);
    did(kOriented);
    for (std::size_t f = 0; f < signs.size(); ++f)
      face_normals_.emplace_back(signs[f] * geometry(f).normal);
    add_normals();
    did(kNormals);
    for (int round = 0; round < smoothing; ++round) {
      smooth_normals();
      did(kNormals);
    }
    spread(face_tensors());
    did(kTensors);
    for (int round = 0; round < smoothing; ++round) {
      spread(gathered());
      did(kSmoothed);
    }
  }

  [[nodiscard]] double curvedness(std::int32_t vertex) const {
    const WeightedTensor& at = tensors_[as_size(surface_.ordered().welded(vertex))];
    return at.weight > 0.0 ? at.sum.norm() / at.weight / std::numbers::sqrt2 : 0.0;
  }

 private:
  [[nodiscard]] const FaceGeometry& geometry(std::size_t f) const {
    return surface_.ordered().geometry(nth_face(f));
  }
  [[nodiscard]] Face corners(std::size_t f) const {
    return surface_.ordered().welded_corners(nth_face(f));
  }
  /// Whether a face has no information about curvature, because it has no area or two of its
  /// corners are welded.
  [[nodiscard]] bool is_lost(std::size_t f) const {
    const auto [a, b, c] = corners(f);
    return geometry(f).moments.area <= 0.0 || a == b || b == c || c == a;
  }
  [[nodiscard]] Vec3& normal_at(std::int32_t vertex) { return normals_[as_size(vertex)]; }

  /// With the weights of Max (1999), the normals are exact if the vertices lie on a sphere.
  void add_normals() {
    for (std::size_t f = 0; f < face_normals_.size(); ++f) {
      check_at(context_, f);
      if (is_lost(f)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Face face = corners(f);
        const Vec3& apex = surface_.ordered().vertex(face[k]);
        const double u = (surface_.ordered().vertex(face[(k + 1) % 3]) - apex).squaredNorm();
        const double v = (surface_.ordered().vertex(face[(k + 2) % 3]) - apex).squaredNorm();
        normal_at(face[k]) += geometry(f).moments.area / (u * v) * face_normals_[f];
      }
    }
    for (Vec3& normal : normals_) normal.stableNormalize();
  }

  void smooth_normals() {
    std::vector<Vec3> sums(normals_.size(), Vec3::Zero());
    for (std::size_t f = 0; f < face_normals_.size(); ++f) {
      check_at(context_, f);
      const auto [a, b, c] = corners(f);
      const Vec3 part = geometry(f).moments.area * (normal_at(a) + normal_at(b) + normal_at(c));
      for (const std::int32_t v : corners(f)) sums[as_size(v)] += part;
    }
    for (std::size_t v = 0; v < sums.size(); ++v)
      if (sums[v].norm() > 0.0) normals_[v] = sums[v].stableNormalized();
  }

  [[nodiscard]] std::vector<bool> border_vertices() const {
    std::vector<bool> at_border(normals_.size(), false);
    for (std::size_t f = 0; f < face_normals_.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto h = static_cast<std::int32_t>(3 * f + k);
        if (surface_.ordered().is_border(h))
          at_border[as_size(corners(f)[k])] = at_border[as_size(corners(f)[(k + 1) % 3])] = true;
      }
    return at_border;
  }

  /// The symmetric tensor II in the plane of the face with II e = dn along its edges, by least
  /// squares (Rusinkiewicz 2004, section 3).
  [[nodiscard]] Mat3 tensor(std::size_t f) const {
    const auto [a, b, c] = corners(f);
    const Vec3& normal = face_normals_[f];
    const Vec3 u = (surface_.ordered().vertex(b) - surface_.ordered().vertex(a)).normalized();
    const Vec3 v = normal.cross(u);
    Mat3 matrix = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t from = corners(f)[k], to = corners(f)[(k + 1) % 3];
      const Vec3 edge = surface_.ordered().vertex(to) - surface_.ordered().vertex(from);
      const Vec3 change = normals_[as_size(to)] - normals_[as_size(from)];
      const double x = edge.dot(u), y = edge.dot(v), p = change.dot(u), q = change.dot(v);
      matrix += Mat3{{x * x, x * y, 0.0}, {x * y, x * x + y * y, x * y}, {0.0, x * y, y * y}};
      right += Vec3(p * x, p * y + q * x, q * y);
    }
    const Vec3 found = matrix.ldlt().solve(right);
    return found[0] * u * u.transpose() + found[1] * (u * v.transpose() + v * u.transpose()) +
           found[2] * v * v.transpose();
  }

  [[nodiscard]] std::vector<WeightedTensor> face_tensors() const {
    const std::vector<bool> at_border = border_vertices();
    std::vector<WeightedTensor> parts(face_normals_.size());
    for (std::size_t f = 0; f < parts.size(); ++f) {
      check_at(context_, f);
      if (is_lost(f)) continue;
      const Face face = corners(f);
      const bool inner = std::none_of(face.begin(), face.end(),
                                      [&](std::int32_t v) { return at_border[as_size(v)]; });
      parts[f].weight = geometry(f).moments.area * (inner ? 1.0 : kAtBorder);
      parts[f].sum = parts[f].weight * tensor(f);
    }
    return parts;
  }

  /// For each face, the mean of the tensors of its vertices.
  [[nodiscard]] std::vector<WeightedTensor> gathered() const {
    std::vector<WeightedTensor> parts(face_normals_.size());
    for (std::size_t f = 0; f < parts.size(); ++f) {
      check_at(context_, f);
      if (is_lost(f)) continue;
      for (const std::int32_t v : corners(f))
        parts[f].add(tensors_[as_size(v)], normals_[as_size(v)], face_normals_[f], 1.0 / 3.0);
    }
    return parts;
  }

  /// Set the tensor of each vertex to the sum over its faces.
  void spread(const std::vector<WeightedTensor>& parts) {
    tensors_.assign(normals_.size(), {});
    for (std::size_t f = 0; f < parts.size(); ++f) {
      check_at(context_, f);
      for (const std::int32_t v : corners(f))
        tensors_[as_size(v)].add(parts[f], face_normals_[f], normals_[as_size(v)]);
    }
  }

  const Surface& surface_;
  const Context* context_;
  double done_ = 0.0;
  std::vector<Vec3> face_normals_;  // consistently oriented; zero without area
  std::vector<Vec3> normals_;       // per vertex, unit
  std::vector<WeightedTensor> tensors_;
};

/// The value that `percentile` of the surface's area does not exceed; each vertex stands for a
/// third of its faces.
double area_percentile(const Surface& surface, const std::vector<double>& values, double percentile,
                       const Context* context) {
  std::vector<double> areas(values.size(), 0.0);
  const std::vector<Face> faces = surface.faces();
  if (context) context->check();
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const std::int32_t v : faces[f])
      areas[as_size(v)] +=
          surface.ordered()
              .geometry(surface.ordered().ordered_face(static_cast<std::int32_t>(f)))
              .moments.area /
          3.0;
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::size_t comparisons = 0;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    check_at(context, ++comparisons, 65536);
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  });
  double reached = 0.0;
  for (const std::size_t v : order) {
    reached += areas[v];
    if (reached >= percentile / 100.0 * surface.area()) return values[v];
  }
  return values[order.back()];
}

void check_range(const char* name, double value, double low, bool with_low, double high) {
  if (value > low && value <= high) return;
  if (with_low && value == low) return;
  throw ArgumentError(std::string(name) + " is " + number(value) + ": it must be in " +
                      (with_low ? "[" : "(") + number(low) + ", " + number(high) + "]");
}

}  // namespace

std::vector<double> curvedness(const Surface& surface, int smoothing, Context* context) {
  check_range("smoothing", smoothing, 0.0, true, 100.0);
  if (context) context->check();
  Stretch finding(context, 0.0, kFound);
  const CurvatureField field(surface, smoothing, finding.context());
  std::vector<double> result(surface.vertex_count(), 0.0);
  const std::vector<Face> faces = surface.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(context, f);
    const Face& ordered =
        surface.ordered().corners(surface.ordered().ordered_face(static_cast<std::int32_t>(f)));
    for (std::size_t k = 0; k < 3; ++k) result[as_size(faces[f][k])] = field.curvedness(ordered[k]);
  }
  if (context) context->advance(1.0);
  return result;
}

std::vector<double> curvature_density(const Surface& surface, const CurvatureOptions& options,
                                      Context* context) {
  check_positive("exponent", options.exponent);
  check_range("floor", options.floor, 0.0, true, 1.0);
  check_range("percentile", options.percentile, 0.0, false, 100.0);
  Stretch bending(context, 0.0, kKnown);
  std::vector<double> values = curvedness(surface, options.smoothing, bending.context());
  const double rounding = kFlat / std::sqrt(surface.area());
  double clamp = area_percentile(surface, values, options.percentile, context);
  if (clamp <= rounding) clamp = *std::max_element(values.begin(), values.end());
  for (double& value : values) {
    const double share = clamp <= rounding ? 1.0 : std::min(1.0, value / clamp);
    value = options.floor + (1.0 - options.floor) * power(share, options.exponent);
  }
  if (context) context->advance(1.0);
  return values;
}

}  // namespace dapple
