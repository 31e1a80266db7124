// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "optimize/minimizer.hpp"
#include "relax/region.hpp"

namespace dapple {

/// A class that takes part in a relaxation: it is relaxed, or it stays in place around those that
/// are.
struct Participant {
  const Surface* surface;  ///< with its density; of the same faces
  double weight;           ///< of its density in the union: count / capacity
  double radius;           ///< of its discs
  Sites sites = {};        ///< sites that do not move
};

/// The classes that take part in a relaxation.
struct Participants {
  std::vector<Participant> relaxed;  ///< in the order of the free classes
  std::vector<Participant> fixed;    ///< classes around them
  double union_weight = 1.0;         ///< weight of the evenness of all classes together
};

/// A class whose sites move; all such classes have regions of the same faces.
struct FreeClass {
  const Region* region;
  std::shared_ptr<const SurfaceDomain> domain;  ///< of the region's part
  double share;  ///< wanted capacity per site, in the unit of the domain's integrals
};

/// Whether discs of sites in the region overlap, including those of other classes.
[[nodiscard]] bool discs_overlap(const Region& region, const Participants& participants);

/// Minimize over the free sites of a region so that each class is even by itself and together with
/// all others around it. The first term of the result is that of the union, followed by those of
/// the classes; with only one class on the part there is a single term.
[[nodiscard]] Minimum minimize_free(std::span<const FreeClass> free_classes,
                                    const Participants& participants,
                                    const OptimizerOptions& options, Context* context);

}  // namespace dapple
