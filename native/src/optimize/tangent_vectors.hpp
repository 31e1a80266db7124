// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/parallel.hpp"
#include "base/tangent_basis.hpp"
#include "base/vectors.hpp"

namespace dapple {

/// Coordinates in a tangent plane. In single precision they would be faster by a few percent, but
/// the last digit of a density would then change the samples by a millionth of their spacing.
struct Tangent {
  double u = 0.0, v = 0.0;

  Tangent& operator+=(const Tangent& other) {
    u += other.u;
    v += other.v;
    return *this;
  }
  friend Tangent operator+(Tangent a, const Tangent& b) { return a += b; }
  friend Tangent operator*(double factor, const Tangent& a) { return {factor * a.u, factor * a.v}; }
  friend Tangent operator-(const Tangent& a) { return {-a.u, -a.v}; }
  [[nodiscard]] double dot(const Tangent& other) const { return u * other.u + v * other.v; }
};

/// One per site.
using TangentVectors = std::vector<Tangent>;
using TangentBasis = Eigen::Matrix<double, 3, 2>;

/// A symmetric matrix on a tangent plane.
struct TangentBlock {
  double uu = 0.0, uv = 0.0, vv = 0.0;

  void add_square(const Tangent& a) {
    uu += a.u * a.u;
    uv += a.u * a.v;
    vv += a.v * a.v;
  }
  TangentBlock& operator+=(const TangentBlock& other) {
    uu += other.uu;
    uv += other.uv;
    vv += other.vv;
    return *this;
  }
  TangentBlock& operator-=(const TangentBlock& other) {
    uu -= other.uu;
    uv -= other.uv;
    vv -= other.vv;
    return *this;
  }
  friend TangentBlock operator*(double factor, const TangentBlock& a) {
    return {factor * a.uu, factor * a.uv, factor * a.vv};
  }
  /// Of this plus `diagonal` times the identity.
  [[nodiscard]] TangentBlock inverse(double diagonal) const {
    const double a = uu + diagonal, c = vv + diagonal;
    const double determinant = a * c - uv * uv;
    return {c / determinant, -uv / determinant, a / determinant};
  }
  Tangent operator*(const Tangent& a) const { return {uu * a.u + uv * a.v, uv * a.u + vv * a.v}; }
};

/// The coordinates of a vector's part in the plane, times a factor.
inline Tangent to_tangent(const TangentBasis& basis, const Vec3& x, double factor) {
  return {factor * basis.col(0).dot(x), factor * basis.col(1).dot(x)};
}

inline Vec3 to_space(const TangentBasis& basis, const Tangent& a, double factor) {
  return factor * (a.u * basis.col(0) + a.v * basis.col(1));
}

inline double dot(const TangentVectors& a, const TangentVectors& b) {
  return parallel_sum(a.size(), kVectorGrain, [&](std::size_t k) { return a[k].dot(b[k]); });
}

}  // namespace dapple
