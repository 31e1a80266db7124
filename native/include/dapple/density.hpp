// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Where values of a density are given; on each face it is linear.
enum class DensityAt {
  kVertices,  ///< one per vertex: continuous over the surface
  kFaces,     ///< one per face: constant on it
  kCorners,   ///< three per face, of its corners 0, 1, 2: it may jump between faces
};

/// A wanted density as a caller gives it, in the caller's order; no values mean 1 everywhere.
struct Density {
  DensityAt at = DensityAt::kVertices;
  std::span<const double> values = {};
};

}  // namespace dapple
