// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/minimizer.hpp"

namespace dapple {

/// Finish a minimum on bodies that are stuck into each other (see Joints::bodies). There the
/// surface is full of narrow places, where the energy jumps as cells exchange pieces: a few places
/// end the steps of all sites, and their share of the energy is too small to go on for. So what is
/// left is done in these places alone, while the other sites stay: cells that are far from even,
/// and sites on two bodies that stand beside each other. Nothing changes where there is no such
/// place.
/// \param objective that of the minimum, of one class without discs
/// \throw Cancelled
void mend_places(const Objective& objective, const OptimizerOptions& options, Minimum& found,
                 Context* context);

}  // namespace dapple
