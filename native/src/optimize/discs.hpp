// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/repulsion.hpp"

namespace dapple {

/// Discs around sites, in the surface: two overlap where their sites are nearer than the sum R of
/// their radii and on the same side of a wall. A disc of radius 0 is a point: others keep it out,
/// and two points do not meet.
struct Discs {
  const Sites& sites;
  const Vectors& normals;            ///< of the surface, per site
  const std::vector<double>& radii;  ///< per site, >= 0
  double period = 0.0;               ///< of the torus; 0 elsewhere
};

/// The repulsion between discs: r_ij is R, and all pairs count, whether their cells touch or not.
[[nodiscard]] Repulsion evaluate_disc_repulsion(const Discs& discs, double weight);

/// The pairs of discs that moves bring closer than R.
[[nodiscard]] std::vector<Contact> discs_brought_together(const Discs& discs,
                                                          const std::vector<bool>& locked,
                                                          const Vectors& moves);

/// Change moves so that no two discs come closer than R, and overlapping ones separate. To first
/// order only: errors of a step along a curved surface are left to the next step. \param locked per
/// site, whether it stays; empty: none
void keep_discs_apart(const Discs& discs, const std::vector<bool>& locked, Vectors& moves);

}  // namespace dapple
