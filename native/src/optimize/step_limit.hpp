// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/objective.hpp"

namespace dapple {

/// How far a site may move in one step.
/// \param max_step in local spacings
[[nodiscard]] double longest_step(const Objective& objective, const Evaluation& state,
                                  double max_step, std::size_t k);

/// The longest move of a site with a cell, relative to the longest step allowed there.
[[nodiscard]] double step_excess(const Objective& objective, const Evaluation& state,
                                 double max_step, const Vectors& moves);

}  // namespace dapple
