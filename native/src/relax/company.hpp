// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "optimize/minimizer.hpp"
#include "relax/region.hpp"

namespace dapple {

/// A class of samples among which another one is relaxed, or that one itself.
struct Companion {
  const Surface* surface;  ///< with its density; of the same faces
  double weight;           ///< of that density in the sum of all: its count / its capacity
  double radius;           ///< of its discs
  Sites sites = {};        ///< those that stay where they are
};

/// What classes are relaxed among.
struct Company {
  std::vector<Companion> selves;  ///< the classes themselves
  std::vector<Companion> others;
  double union_weight = 1.0;  ///< of the evenness of all together
};

/// A class that is relaxed. All have regions of the same faces.
struct Self {
  const Region* region;
  const SurfaceDomain* domain;  ///< of the region's part
  double share;                 ///< capacity that each is to have, as the domain's integrals
};

/// Whether discs around sites of the region overlap, those of others that are on it too.
[[nodiscard]] bool discs_overlap(const Region& region, const Company& company);

/// Minimize over the free sites of a region, where each class is to be even by itself and with all
/// that are around it. The first term of what is found is that of all, the next ones those of the
/// classes; if there is but one class on the part, its term is that of all.
[[nodiscard]] Minimum even_among(std::span<const Self> selves, const Company& company,
                                 const OptimizerOptions& options, Context* context);

}  // namespace dapple
