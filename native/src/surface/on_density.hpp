// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <span>

#include "surface/ordered_face.hpp"

namespace dapple {

/// Whether a face has an area with density.
[[nodiscard]] bool has_density(const Surface& surface, OrderedFace face);

/// Whether a surface has faces with area and without density.
[[nodiscard]] bool has_gaps(const Surface& surface);

/// Whether a sample may lie at a point of the caller's face, that is, whether the density there is
/// above 0.
[[nodiscard]] bool is_on_density(const Surface& surface, std::int32_t face, const Vec3& weights);

/// Move points at which the face's density is exactly 0 a little toward its largest value.
/// \param faces the caller's, each with some density
void move_off_zeros(const Surface& surface, std::span<const std::int32_t> faces,
                    std::span<Vec3> weights, std::span<Vec3> positions);

}  // namespace dapple
