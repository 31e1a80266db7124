// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>
#include <string>

namespace dapple {

// The bytes of a file, in each of the formats.
// \pre the faces' vertices exist

/// Text with the fewest digits from which the same numbers can be read.
[[nodiscard]] std::string to_off(std::span<const Vec3> vertices, std::span<const Face> faces);
[[nodiscard]] std::string to_obj(std::span<const Vec3> vertices, std::span<const Face> faces);

/// Binary, in double precision.
[[nodiscard]] std::string to_ply(std::span<const Vec3> vertices, std::span<const Face> faces);

/// Binary, in single precision.
/// \throw ArgumentError naming the first vertex that is too large for it
[[nodiscard]] std::string to_stl(std::span<const Vec3> vertices, std::span<const Face> faces);

}  // namespace dapple
