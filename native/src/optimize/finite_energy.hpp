// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/energy.hpp>
#include <span>

#include "optimize/objective.hpp"

namespace dapple {

/// A face has hardly any area where it is a needle, but it may reach so far that the squares of
/// distances in it are beyond the range of numbers.
/// \param members indices of the energy's sites; empty if they are all of them
/// \throw SurfaceError naming the first site with such a cell
void check_finite(const Energy& energy, std::span<const std::int32_t> members = {});

/// The same for each term.
void check_finite(const Objective& objective, const State& state);

}  // namespace dapple
