// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace dapple {

/// A hash of two indices; its upper half is well mixed.
inline std::uint64_t pair_hash(std::int32_t first, std::int32_t second) {
  return static_cast<std::uint64_t>(first) * 0x9e3779b97f4a7c15u +
         static_cast<std::uint64_t>(second) * 0xc2b2ae3d27d4eb4fu;
}

}  // namespace dapple
