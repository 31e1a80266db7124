// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// The chosen sites.
[[nodiscard]] Sites select(const Sites& sites, std::span<const std::int32_t> members);
[[nodiscard]] Sites select(const Sites& sites, std::span<const std::size_t> members);
/// The same in the memory of `chosen`.
void select(const Sites& sites, std::span<const std::int32_t> members, Sites& chosen);

/// All but the first so many sites.
[[nodiscard]] Sites without_first(const Sites& sites, std::size_t count);

/// Put chosen sites back: the inverse of select().
void put(Sites& sites, std::span<const std::int32_t> members, const Sites& chosen);

/// Append sites.
void append(Sites& sites, const Sites& more);

}  // namespace dapple
