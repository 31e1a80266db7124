// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <dapple/types.hpp>

namespace dapple {

/// Three numbers that stay in registers. Eigen processes two numbers of a Vec3 at once and the
/// third alone, and passes them through memory in between: too slow for each corner of each piece
/// of a cell. Sums have the same order, so results are the same bytes.
struct Triple {
  double x, y, z;

  Triple() = default;  // numbers without values
  // Copied number by number: a copy of the whole would wait for the last numbers to be stored.
  Triple(const Triple& other) : x(other.x), y(other.y), z(other.z) {}
  Triple& operator=(const Triple& other) {
    x = other.x;
    y = other.y;
    z = other.z;
    return *this;
  }
  Triple(double first, double second, double third) : x(first), y(second), z(third) {}
  explicit Triple(const Vec3& v) : x(v[0]), y(v[1]), z(v[2]) {}

  void store(Vec3& v) const {
    v[0] = x;
    v[1] = y;
    v[2] = z;
  }
  void add_to(Vec3& v) const {
    v[0] += x;
    v[1] += y;
    v[2] += z;
  }
  [[nodiscard]] double dot(const Triple& b) const { return x * b.x + y * b.y + z * b.z; }
  [[nodiscard]] double squared_norm() const { return dot(*this); }
  [[nodiscard]] double norm() const { return std::sqrt(squared_norm()); }
  [[nodiscard]] Triple cross(const Triple& b) const {
    return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x};
  }
};

inline Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Triple operator-(const Triple& a, const Triple& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Triple operator*(double s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }

}  // namespace dapple
