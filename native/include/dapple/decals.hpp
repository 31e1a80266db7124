// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <dapple/texture.hpp>

namespace dapple {

/// The sample whose decal covers each texel, and the place on the decal.
struct DecalCover {
  std::vector<std::int32_t> samples;  ///< per texel; -1: none
  std::vector<Vec2> places;  ///< on the decal, in [-1, 1] x [-1, 1] with (0, 0) in the middle
};

/// Lay a square decal on the surface around each sample (paper, section 5.3 and Fig. 16b).
///
/// A decal's x axis runs along the sample's tangent, y along normal x tangent. It lies in the
/// tangent plane and is bent onto the surface so that distances from its middle are kept. Parts
/// that face away from the sample's normal, or lie farther above or below it than its radius,
/// belong to another sheet and are not covered. Where decals overlap, a texel goes to the one whose
/// middle is nearest relative to its radius.
/// \param radii    per sample: half the side of its decal, >= 0, in the surface's units
/// \param tangents per sample; made perpendicular to the normal here
/// \throw ArgumentError for arrays of another length than the samples, the first radius that is
/// negative or not finite, the first tangent along the normal; Cancelled
[[nodiscard]] DecalCover decal_cover(const Surface& surface, const Samples& samples,
                                     std::span<const double> radii, std::span<const Vec3> tangents,
                                     const Texels& texels, Context* context = nullptr);

}  // namespace dapple
