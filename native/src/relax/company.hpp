// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "optimize/minimizer.hpp"
#include "relax/region.hpp"

namespace dapple {

/// A class that takes part in a relaxation: one that is relaxed, or one that stays in place around
/// it.
struct Companion {
  const Surface* surface;  ///< with its density; of the same faces
  double weight;           ///< of its density in the union: count / capacity
  double radius;           ///< of its discs
  Sites sites = {};        ///< sites that do not move
};

/// The classes that take part in a relaxation.
struct Company {
  std::vector<Companion> selves;  ///< the classes themselves
  std::vector<Companion> others;
  double union_weight = 1.0;  ///< weight of the evenness of all classes together
};

/// A class that is relaxed; all such classes have regions of the same faces.
struct Self {
  const Region* region;
  const SurfaceDomain* domain;  ///< of the region's part
  double share;                 ///< wanted capacity per site, in the unit of the domain's integrals
};

/// Whether discs of sites in the region overlap, including those of other classes.
[[nodiscard]] bool discs_overlap(const Region& region, const Company& company);

/// Minimize over the free sites of a region so that each class is even by itself and together with
/// all others around it. The first term of the result is that of the union, followed by those of
/// the classes; with only one class on the part there is a single term.
[[nodiscard]] Minimum even_among(std::span<const Self> selves, const Company& company,
                                 const OptimizerOptions& options, Context* context);

}  // namespace dapple
