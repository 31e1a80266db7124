// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.hpp"

namespace dapple {

// In what follows `order` lists the caller's indices of groups of `width` values, in another order.
// A Poll is asked now and then.

template <typename T>
std::vector<T> gather(std::span<const T> values, std::span<const std::int32_t> order,
                      std::size_t width = 1) {
  std::vector<T> result;
  result.reserve(values.size());
  if (!values.empty())
    for (const std::int32_t group : order) {
      check_at(result.size());
      for (std::size_t k = 0; k < width; ++k)
        result.push_back(values[width * static_cast<std::size_t>(group) + k]);
    }
  return result;
}

template <typename T>
std::vector<T> scatter(std::span<const T> values, std::span<const std::int32_t> order,
                       std::size_t width = 1) {
  std::vector<T> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    check_at(k);
    result[width * static_cast<std::size_t>(order[k / width]) + k % width] = values[k];
  }
  return result;
}

}  // namespace dapple
