// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <dapple/texture.hpp>

namespace dapple {

/// Which sample's decal covers each texel, and where on it.
struct DecalCover {
  std::vector<std::int32_t> samples;  ///< per texel; -1: none
  std::vector<Vec2> places;           ///< in [-1, 1] x [-1, 1], on the decal; (0, 0) its middle
};

/// Lay a square decal on the surface around each sample (paper, section 5.3 and Fig. 16b).
///
/// A decal's x axis runs along the sample's tangent, y along normal x tangent. It lies in the
/// tangent plane and is bent onto the surface so that distances from its middle stay as they are.
/// Parts that face away from the sample's normal, or are farther above or below it than its
/// radius, belong to another sheet and get nothing. Where decals overlap, a texel goes to the one
/// whose middle is nearest, measured in its radius.
/// \param radii    per sample: half the side of its decal, >= 0, in the surface's units
/// \param tangents per sample; made perpendicular to the normal here
/// \throw ArgumentError for arrays of another length than the samples, the first radius that is
/// negative or not finite, the first tangent along the normal; Cancelled
[[nodiscard]] DecalCover cover(const Surface& surface, const Samples& samples,
                               std::span<const double> radii, std::span<const Vec3> tangents,
                               const Texels& texels, Context* context = nullptr);

}  // namespace dapple
