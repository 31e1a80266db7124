// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace dapple {

/// Values in rows and columns, row 0 at the bottom (y = 0); `values[row * columns + column]`.
struct Image {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
};

}  // namespace dapple
