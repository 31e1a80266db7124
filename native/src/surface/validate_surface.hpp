// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <dapple/types.hpp>
#include <string>

namespace dapple {

// What lies on a surface comes in through one of the next three, or check_samples(), wherever it
// comes from.

/// \throw ArgumentError naming the first site that is not finite or whose face is out of range; if
/// the arrays' lengths differ (there may be no barycentric coordinates)
void check_sites(const Surface& surface, const Sites& sites);

/// Faces with barycentric coordinates, which need not be normalized to the last digit.
/// \param owner what they are of, for the message
/// \throw ArgumentError naming the first face out of range, row that is not finite, below 0 or
/// does not sum to 1 (all within 1e-4); if the lengths differ
void check_binding(const std::string& owner, const Surface& surface,
                   std::span<const std::int32_t> faces, std::span<const Vec3> barycentric);

/// Sites whose positions are where their barycentric coordinates say.
/// \throw ArgumentError as check_sites() and check_binding(), and naming the first site that is
/// elsewhere, as those of another surface are
void check_bound_sites(const std::string& owner, const Surface& surface, const Sites& sites);

/// The same where the positions may be those of any of several frames of one body.
void check_bound_sites(const std::string& owner, std::span<const Surface* const> frames,
                       const Sites& sites);

/// \param hints a face near each of the points, or none
/// \throw ArgumentError naming the first point that is not finite or hint that is out of range
void check_hints(const Surface& surface, std::span<const Vec3> points,
                 std::span<const std::int32_t> hints);

/// \throw ArgumentError unless there is a row for each face, naming the first texture coordinate
/// that is not finite or beyond 1e6
void check_uv(const Surface& surface, std::span<const FaceUv> uv);

}  // namespace dapple
