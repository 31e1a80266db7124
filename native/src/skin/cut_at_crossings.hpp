// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>

namespace dapple {

/// Cut faces along the lines where they pass through each other, and connect them there: the cells
/// of samples then reach from one part of a model to another that is stuck through it.
///
/// Every cut face has added vertices of its own, so that each follows its part when the surface
/// deforms; edges at the same place are connected (Joints).
/// \throw Cancelled
[[nodiscard]] Refined cut_at_crossings(const Surface& surface, Context* context = nullptr);

}  // namespace dapple
