// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// One vector per site; sums run in the order of the sites, so that they do not depend on the
/// number of threads.
using Vectors = std::vector<Vec3>;

inline double dot(const Vectors& a, const Vectors& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k].dot(b[k]);
  return sum;
}

inline void add_scaled(Vectors& a, double factor, const Vectors& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += factor * b[k];
}

inline Vectors difference(const Vectors& a, const Vectors& b) {
  Vectors result(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) result[k] = a[k] - b[k];
  return result;
}

/// Remove the part along the normals.
inline void make_tangential(Vectors& v, const Vectors& normals) {
  for (std::size_t k = 0; k < v.size(); ++k) v[k] -= v[k].dot(normals[k]) * normals[k];
}

}  // namespace dapple
