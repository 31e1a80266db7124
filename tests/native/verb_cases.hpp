// SPDX-License-Identifier: GPL-3.0-or-later
// Calls of all verbs, on inputs that are just large enough for all their passes.
#pragma once

#include <functional>
#include <iosfwd>
#include <span>

#include "hash.hpp"

namespace dapple::test {

/// One call of a verb, which adds its result to the hash.
using Work = std::function<void(Hash&)>;

/// Prepares a call of a verb, with inputs that no call has used before.
using Prepare = std::function<Work()>;

/// For calls that do not change their inputs.
[[nodiscard]] Prepare again(Work work);

struct Case {
  const char* name;
  Prepare (*prepare)(int threads);
  long lost = 0;  ///< allocations that a library of others never frees
};
void PrintTo(const Case& one, std::ostream* out);

[[nodiscard]] std::span<const Case> verb_cases();

}  // namespace dapple::test
