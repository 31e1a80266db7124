// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

#include "base/parallel.hpp"

namespace dapple {

/// One vector per site; sums run over chunks of the sites in order, so that they do not depend on
/// the number of threads.
using Vectors = std::vector<Vec3>;
constexpr std::size_t kVectorGrain = 4096;  // sites a chunk

inline double dot(const Vectors& a, const Vectors& b) {
  return parallel_sum(a.size(), kVectorGrain, [&](std::size_t k) { return a[k].dot(b[k]); });
}

/// Call set(k) for each of `count` vectors, in parallel.
template <typename Set>
void for_each_vector(std::size_t count, const Set& set) {
  parallel_chunks(count, kVectorGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) set(k);
  });
}

inline void add_scaled(Vectors& a, double factor, const Vectors& b) {
  for_each_vector(a.size(), [&](std::size_t k) { a[k] += factor * b[k]; });
}

inline Vectors difference(const Vectors& a, const Vectors& b) {
  Vectors result(a.size());
  for_each_vector(a.size(), [&](std::size_t k) { result[k] = a[k] - b[k]; });
  return result;
}

/// Remove the part along the normals.
inline void make_tangential(Vectors& v, const Vectors& normals) {
  for_each_vector(v.size(), [&](std::size_t k) { v[k] -= v[k].dot(normals[k]) * normals[k]; });
}

}  // namespace dapple
