// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/connectivity.hpp"

namespace dapple {

/// Per vertex the first one within the tolerance.
/// \throw Cancelled
[[nodiscard]] std::vector<std::int32_t> places_of(std::span<const Vec3> vertices, double tolerance,
                                                  const Context* context);

/// The faces whose corners are at the same three places as those of one before them in the
/// caller's order.
/// \param mesh   with faces and their order
/// \param places per vertex of the mesh: equal if at one place
/// \throw Cancelled
[[nodiscard]] std::vector<DoubledFace> find_doubled(const Connectivity& mesh,
                                                    std::span<const std::int32_t> places,
                                                    const Context* context);

/// Per face whether it does not count; empty where all do.
[[nodiscard]] std::vector<bool> left_out_faces(const Connectivity& mesh);

}  // namespace dapple
