// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <dapple/types.hpp>
#include <vector>

namespace dapple {

/// Values in rows and columns, row 0 at the bottom (y = 0); `values[row * columns + column]`.
struct Image {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
};

/// Texture coordinates (u, v) of the corners 0, 1, 2 of a face: (0, 0) is the outer corner of an
/// image's first pixel, (1, 1) that of its last.
using FaceUv = std::array<Vec2, 3>;

}  // namespace dapple
