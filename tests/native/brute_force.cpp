// SPDX-License-Identifier: GPL-3.0-or-later
#include "brute_force.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace dapple::test {
namespace {

constexpr std::int32_t kFaceEdge = -1;

/// A convex polygon; edge k runs from point k to point k + 1 and stores the site whose bisector
/// produced it.
struct Polygon {
  std::vector<Vec3> points;
  std::vector<std::int32_t> edges;
};

/// The density phi in the plane of a face, interpolated from its corners.
class LinearDensity {
 public:
  LinearDensity(const Shape& shape, std::size_t face) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(shape.faces[face][c]);
      corner_[c] = shape.vertices[v];
    }
    value_ = shape.densities(static_cast<std::int32_t>(face));
    normal_ = (corner_[1] - corner_[0]).cross(corner_[2] - corner_[0]);
  }

  [[nodiscard]] const Vec3& corner(std::size_t c) const { return corner_[c]; }
  [[nodiscard]] const Vec3& normal() const { return normal_; }  // length: twice the area

  [[nodiscard]] double operator()(const Vec3& p) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 part = (corner_[(c + 1) % 3] - p).cross(corner_[(c + 2) % 3] - p);
      sum += value_[static_cast<Eigen::Index>(c)] * part.dot(normal_);
    }
    return sum / normal_.squaredNorm();
  }

 private:
  std::array<Vec3, 3> corner_;
  Vec3 value_;
  Vec3 normal_;
};

/// Keep the part that is nearer to site i than to site j; the lower index gets a tie.
Polygon cut(const Polygon& polygon, const std::vector<Vec3>& sites, std::size_t i, std::size_t j) {
  const Vec3 across = sites[j] - sites[i];
  const Vec3 middle = 0.5 * (sites[i] + sites[j]);
  const auto depth = [&](const Vec3& p) { return (middle - p).dot(across); };
  const auto inside = [&](double d) { return d > 0.0 || (d == 0.0 && i < j); };
  Polygon kept;
  const std::size_t count = polygon.points.size();
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3& p = polygon.points[k];
    const Vec3& q = polygon.points[(k + 1) % count];
    const double dp = depth(p), dq = depth(q);
    if (inside(dp)) {
      kept.points.push_back(p);
      kept.edges.push_back(polygon.edges[k]);
    }
    if (inside(dp) == inside(dq)) continue;
    kept.points.emplace_back(p + dp / (dp - dq) * (q - p));
    kept.edges.push_back(inside(dp) ? static_cast<std::int32_t>(j) : polygon.edges[k]);
  }
  return kept;
}

/// Seven points of degree 5 (Radon 1948): exact for phi^2 |x - o|^2.
void add_triangle(const LinearDensity& density, const Vec3& origin,
                  const std::array<Vec3, 3>& corner, Moments& sum) {
  const double area = 0.5 * (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
  const auto add = [&](const Vec3& weights, double weight) {
    const Vec3 p = weights[0] * corner[0] + weights[1] * corner[1] + weights[2] * corner[2];
    const Vec3 r = p - origin;
    const double phi = density(p), dose = weight * area;
    sum.area += dose;
    sum.capacity += dose * phi;
    sum.mass += dose * phi * phi;
    sum.first += dose * phi * phi * r;
    sum.second += dose * phi * phi * r.squaredNorm();
  };
  add(Vec3::Constant(1.0 / 3.0), 9.0 / 40.0);
  for (const double sign : {-1.0, 1.0}) {
    const double near = (6.0 + sign * std::sqrt(15.0)) / 21.0;
    const double weight = (155.0 + sign * std::sqrt(15.0)) / 1200.0;
    for (int c = 0; c < 3; ++c) {
      Vec3 weights = Vec3::Constant(near);
      weights[c] = 1.0 - 2.0 * near;
      add(weights, weight);
    }
  }
}

/// Three-point Gauss rule along a boundary segment.
Vec3 segment_flux(const LinearDensity& density, const Vec3& site, const Vec3& p, const Vec3& q) {
  const double length = (q - p).norm();
  Vec3 sum = Vec3::Zero();
  for (const int k : {-1, 0, 1}) {
    const Vec3 x = 0.5 * (p + q) + 0.5 * k * std::sqrt(0.6) * (q - p);
    sum += (k == 0 ? 8.0 : 5.0) / 18.0 * length * density(x) * (x - site);
  }
  return sum;
}

void add_polygon(const LinearDensity& density, const std::vector<Vec3>& sites, std::size_t i,
                 const Polygon& polygon, BruteCell& cell) {
  const auto& points = polygon.points;
  for (std::size_t k = 1; k + 1 < points.size(); ++k)
    add_triangle(density, sites[i], {points[0], points[k], points[k + 1]}, cell.moments);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::int32_t j = polygon.edges[k];
    if (j == kFaceEdge) continue;
    const Vec3& p = points[k];
    const Vec3& q = points[(k + 1) % points.size()];
    const Vec3 across = sites[static_cast<std::size_t>(j)] - sites[i];
    const double in_plane = across.cross(density.normal().normalized()).norm();
    const auto flux = cell.flux.try_emplace(j, Vec3::Zero()).first;
    flux->second += segment_flux(density, sites[i], p, q) / in_plane;
    cell.length[j] += (q - p).norm();
  }
}

/// The first site at this position.
bool leads(const std::vector<Vec3>& sites, std::size_t i) {
  return std::find(sites.begin(), sites.end(), sites[i]) ==
         sites.begin() + static_cast<std::ptrdiff_t>(i);
}

}  // namespace

std::vector<BruteCell> brute_force_cells(const Shape& shape, const std::vector<Vec3>& sites) {
  std::vector<BruteCell> cells(sites.size());
  const std::vector<bool> counts = shape.counted();
  for (std::size_t f = 0; f < shape.faces.size(); ++f) {
    if (!counts[f]) continue;
    const LinearDensity density(shape, f);
    if (density.normal().isZero(0.0)) continue;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (!leads(sites, i)) continue;
      Polygon polygon{{density.corner(0), density.corner(1), density.corner(2)},
                      {kFaceEdge, kFaceEdge, kFaceEdge}};
      for (std::size_t j = 0; j < sites.size() && !polygon.points.empty(); ++j)
        if (sites[j] != sites[i]) polygon = cut(polygon, sites, i, j);
      add_polygon(density, sites, i, polygon, cells[i]);
    }
  }
  return cells;
}

Vec3 closest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

}  // namespace dapple::test
