// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>
#include <span>

namespace dapple {

/// The samples of one class, with its energy from the report of all.
/// \param surface with the density of the class
[[nodiscard]] Samples of_class(const Surface& surface, const Samples& all, std::int32_t one);

/// Join classes, some of whose samples were removed or added: first those that stay, in their
/// order. The report is not computed.
/// \param parts samples of each class; those that stay keep their ids
[[nodiscard]] Samples joined(const Surface& surface, const Samples& before,
                             std::span<const Samples> parts);

}  // namespace dapple
