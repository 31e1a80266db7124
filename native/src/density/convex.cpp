// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/convex.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/triangle.hpp"

namespace dapple {
namespace {

constexpr int kMostSteps = 64;
constexpr double kRounding = 1e-12;   // of the largest coordinate
constexpr double kConverged = 1e-10;  // relative gain of a squared distance that ends the search
constexpr double kFlat = 1e-12;       // volume of a flat tetrahedron, of its longest edges' product

/// Up to four points of the difference of two hulls.
struct Simplex {
  std::array<Vec3, 4> corners;
  std::size_t size = 0;
};

double largest_coordinate(std::span<const Vec3> points) {
  double largest = 0.0;
  for (const Vec3& point : points) largest = std::max(largest, point.cwiseAbs().maxCoeff());
  return largest;
}

const Vec3& farthest(std::span<const Vec3> points, const Vec3& direction) {
  std::size_t best = 0;
  double most = points[0].dot(direction);
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double along = points[k].dot(direction);
    if (along > most) {
      most = along;
      best = k;
    }
  }
  return points[best];
}

/// The point of a triangle of the simplex nearest to the origin, and the corners it lies between.
struct Nearest {
  Vec3 place;
  Simplex between;
};

Nearest on_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const std::array<Vec3, 3> corners = {a, b, c};
  const Vec3 weights = closest_barycentric(Vec3::Zero(), a, b, c);
  Nearest found{combined(corners, weights), {}};
  for (int k = 0; k < 3; ++k)
    if (weights[k] > 0.0)
      found.between.corners[found.between.size++] = corners[static_cast<std::size_t>(k)];
  return found;
}

/// Whether a tetrahedron that is not flat contains the origin.
bool holds_origin(const std::array<Vec3, 4>& t) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) { return a.cross(b).dot(c); };
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], w = t[3] - t[0];
  const double whole = volume(u, v, w);
  if (std::abs(whole) <= kFlat * u.norm() * v.norm() * w.norm()) return false;
  const std::array<double, 4> parts = {volume(t[1], t[2], t[3]), -volume(t[0], t[2], t[3]),
                                       volume(t[0], t[1], t[3]), -volume(t[0], t[1], t[2])};
  return std::all_of(parts.begin(), parts.end(),
                     [&](double part) { return whole > 0.0 ? part >= 0.0 : part <= 0.0; });
}

Nearest on_tetrahedron(const std::array<Vec3, 4>& t) {
  if (holds_origin(t)) return {Vec3::Zero(), {t, 4}};
  const std::array<Nearest, 4> sides = {
      on_triangle(t[0], t[1], t[2]), on_triangle(t[0], t[1], t[3]), on_triangle(t[0], t[2], t[3]),
      on_triangle(t[1], t[2], t[3])};
  return *std::min_element(sides.begin(), sides.end(), [](const Nearest& a, const Nearest& b) {
    return a.place.squaredNorm() < b.place.squaredNorm();
  });
}

Nearest nearest_of(const Simplex& simplex) {
  const std::array<Vec3, 4>& t = simplex.corners;
  if (simplex.size == 1) return {t[0], simplex};
  if (simplex.size == 2) return on_triangle(t[0], t[1], t[0]);
  return simplex.size == 3 ? on_triangle(t[0], t[1], t[2]) : on_tetrahedron(t);
}

}  // namespace

// Gilbert, Johnson, Keerthi, A fast procedure for computing the distance between complex objects
// (1988): the point v of the difference nearest to the origin, in simplices of its support points.
// The support point w along -v tells that the distance is at least v . w / |v|.
bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, double distance) {
  const double needed =
      distance + kRounding * std::max(largest_coordinate(a), largest_coordinate(b));
  Nearest now{a[0] - b[0], {{a[0] - b[0]}, 1}};
  for (int step = 0; step < kMostSteps; ++step) {
    const double length = now.place.norm();
    if (length <= needed || now.between.size == 4) return false;
    const Vec3 support = farthest(a, -now.place) - farthest(b, now.place);
    const double along = now.place.dot(support);
    if (along > needed * length) return true;
    if (length * length - along <= kConverged * length * length) return false;
    now.between.corners[now.between.size++] = support;
    now = nearest_of(now.between);
  }
  return false;
}

}  // namespace dapple
