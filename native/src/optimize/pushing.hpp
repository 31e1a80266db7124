// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/minimizer.hpp"

namespace dapple {

/// Push the few sites apart along the surface that a minimum leaves nearer than 0.65 spacings to
/// each other: touching ones, and those of two bodies (see Stranger). A place where the capacities
/// would become much less even stays as it is, and so does everything if many sites are that near.
/// \param objective that of the minimum, of one class without discs
/// \param most evaluations in all
/// \throw Cancelled
void push_apart(const Objective& objective, int most, Minimum& found, Context* context);

}  // namespace dapple
