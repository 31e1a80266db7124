// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>
#include <span>

namespace dapple {

/// The samples of one class, with the energy that it has in the report of all.
/// \param surface with the density of the class
[[nodiscard]] Samples of_class(const Surface& surface, const Samples& all, std::int32_t one);

/// Classes together, some of whose samples are no more or new: first those that stay, in their
/// order. Nothing is measured.
/// \param parts samples of each class; those that stay have their ids
[[nodiscard]] Samples joined(const Surface& surface, const Samples& before,
                             std::span<const Samples> parts);

}  // namespace dapple
