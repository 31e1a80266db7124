// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sampler.hpp>
#include <vector>

namespace dapple {

struct SymmetryOptions {
  SampleOptions sample = {};  // options
  /// Largest distance from the surface that the mirror image of a vertex may have, relative to the
  /// surface's size, the diagonal of its bounding box.
  double max_mirror_error = 0.01;  // expert, >= 0
  /// Normal of the plane of symmetry, of any length.
  Vec3 normal = Vec3::UnitX();
  /// A point of the plane.
  Vec3 point = Vec3::Zero();
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const SymmetryOptions& options);

/// Samples in pairs of mirror images.
struct SymmetricSamples {
  /// Pair after pair, the sample on the normal's side first, then those on the plane.
  Samples samples;
  std::vector<std::int32_t> mirror;  ///< per sample: the index of its image; its own on the plane
  double mirror_error = 0.0;  ///< the largest distance of a sample from the mirror image of its
                              ///< partner: rounding where the surface is symmetric
};

/// Exactly `count` samples of a symmetric surface, evenly spaced and unpatterned, in pairs of
/// mirror images across a plane.
///
/// Samples are first placed as by sample(). Those near the plane move onto it, the others of one
/// side are mirrored, and the energy of all is minimized once more among symmetric configurations.
/// As many are on the plane as a strip of half a spacing holds, so that it is as even and
/// unpatterned as other places; an odd count needs a surface that crosses the plane. The faces need
/// not be symmetric. Where the surface is not, the image of a sample is the surface's nearest
/// point. Where the density is not, its mean over a place and its image counts, also in the report.
/// \throw ArgumentError for options out of range, a normal of length 0, locked samples, naming the
///        first vertex with density whose mirror image is too far from the surface, or for an odd
///        count on a surface that does not cross the plane; Cancelled
[[nodiscard]] SymmetricSamples sample_symmetric(const Surface& surface, std::size_t count,
                                                const SymmetryOptions& options = {},
                                                Context* context = nullptr);

}  // namespace dapple
