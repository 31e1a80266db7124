// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/restoration.hpp"

#include <algorithm>
#include <dapple/analysis.hpp>

namespace dapple {
namespace {

constexpr double kBegin = 0.7;    // of the sufficient variation: a frame below it is not restored
constexpr double kAsFirst = 1.1;  // of the first frame's variation: likewise
constexpr double kIdle = 1e-3;    // weight of E_cvt

/// If sites repel each other, their distances count too.
bool too_near(const Objective& objective, const Evaluation& state, double alpha) {
  return objective.terms[0].repulsion_weight > 0.0 &&
         measure_evenness(state.diagram()).alpha_min < alpha;
}

}  // namespace

double Restoration::cvt_weight(const Objective& objective, const Evaluation& state) const {
  const double above = normalized_cvt(objective, state) - (cvt + dead_band);
  return share * std::clamp(above / band, 0.0, 1.0);
}

bool Restoration::reached(const Objective& objective, const Evaluation& state) const {
  return !too_near(objective, state, alpha) && worst_overlap(state.discs) <= overlap &&
         capacity_variation(objective, state) <= std::max(variation, first_variation);
}

bool Restoration::unnecessary(const Objective& objective, const Evaluation& state) const {
  return objective.cvt_weight < kIdle && !too_near(objective, state, alpha) &&
         worst_overlap(state.discs) <= overlap &&
         capacity_variation(objective, state) <=
             std::max(kBegin * variation, kAsFirst * first_variation);
}

}  // namespace dapple
