// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/triangle.hpp"

#include <algorithm>

namespace dapple {
namespace {

/// Parameter in [0, 1] of the point of segment a, b closest to p.
double closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length = (b - a).squaredNorm();
  return length > 0.0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
}

Vec3 closest_on_edges(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = closest_on_segment(p, a, b);
  const double bc = closest_on_segment(p, b, c);
  const double ca = closest_on_segment(p, c, a);
  const std::array<Vec3, 3> weights = {Vec3(1.0 - ab, ab, 0.0), Vec3(0.0, 1.0 - bc, bc),
                                       Vec3(ca, 0.0, 1.0 - ca)};
  return *std::min_element(weights.begin(), weights.end(), [&](const Vec3& u, const Vec3& v) {
    const auto squared = [&](const Vec3& w) {
      return (w[0] * a + w[1] * b + w[2] * c - p).squaredNorm();
    };
    return squared(u) < squared(v);
  });
}

}  // namespace

// Ericson, Real-Time Collision Detection (2005), 5.1.5: inside if the projection's areas against
// all edges are positive; otherwise the closest point lies on an edge.
Vec3 closest_barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 normal = ab.cross(ac);
  const double squared = normal.squaredNorm();
  if (squared > 0.0) {
    const Vec3 ap = p - a;
    const double v = ap.cross(ac).dot(normal) / squared;
    const double w = ab.cross(ap).dot(normal) / squared;
    const double u = 1.0 - v - w;
    if (u >= 0.0 && v >= 0.0 && w >= 0.0) return {u, v, w};
  }
  return closest_on_edges(p, a, b, c);
}

}  // namespace dapple
