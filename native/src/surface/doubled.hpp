// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>
#include <vector>

#include "surface/ordered_face.hpp"

namespace dapple {

/// A face that coincides with another corner by corner, and is ignored.
struct DoubledFace {
  OrderedFace face;
  OrderedFace counted;                  // the face that it lies on; this one counts
  std::array<std::uint8_t, 3> corners;  // of `counted`, at the corners of `face`
};

/// Per vertex the first one within the tolerance.
/// \throw Cancelled
[[nodiscard]] std::vector<std::int32_t> places_of(std::span<const Vec3> vertices, double tolerance,
                                                  const Context* context);

/// The faces whose corners are at the same three places as those of another that comes before them
/// in the caller's order; sorted.
/// \param faces         ordered
/// \param original_face per face, the caller's index
/// \param places        per vertex: equal if at one place
/// \throw Cancelled
[[nodiscard]] std::vector<DoubledFace> find_doubled(std::span<const Face> faces,
                                                    std::span<const std::int32_t> original_face,
                                                    std::span<const std::int32_t> places,
                                                    const Context* context);

/// Per face whether it does not count; empty where all do.
[[nodiscard]] std::vector<bool> left_out_faces(std::span<const DoubledFace> doubled,
                                               std::size_t face_count);

}  // namespace dapple
