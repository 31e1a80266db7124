// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace dapple {

/// A face in a surface's own order (see Connectivity). The caller's indices are plain integers, so
/// the two cannot be confused.
enum class OrderedFace : std::int32_t {};

/// Conversion to an array index, and back.
constexpr std::size_t as_index(OrderedFace face) { return static_cast<std::size_t>(face); }
constexpr std::size_t as_index(std::int32_t index) { return static_cast<std::size_t>(index); }
constexpr OrderedFace nth_face(std::size_t index) { return static_cast<OrderedFace>(index); }

/// Half-edges are numbered three to a face, by the corner that they start from.
constexpr std::int32_t half_edge(OrderedFace face, std::int32_t corner) {
  return 3 * static_cast<std::int32_t>(face) + corner;
}
constexpr OrderedFace face_of(std::int32_t half_edge) { return OrderedFace{half_edge / 3}; }

}  // namespace dapple
