// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dapple {

/// Disjoint sets of 0..count - 1 that grow together (Galler and Fischer 1964).
class Sets {
 public:
  explicit Sets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  /// The lowest member of the set that `k` is in.
  std::int32_t find(std::int32_t k) {
    while (parent(k) != k) k = parent(k) = parent(parent(k));
    return k;
  }

  void join(std::int32_t a, std::int32_t b) {
    a = find(a);
    b = find(b);
    parent(std::max(a, b)) = std::min(a, b);
  }

 private:
  std::int32_t& parent(std::int32_t k) { return parents_[static_cast<std::size_t>(k)]; }
  std::vector<std::int32_t> parents_;
};

}  // namespace dapple
