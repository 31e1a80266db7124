// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sample/class_problem.hpp"

namespace dapple {

/// Initial positions, and the work that they took.
struct SubdividedStart {
  Sites sites;          ///< none where the surface is too thin
  int evaluations = 0;  ///< one of a quarter of the sites counts as a quarter
};

/// Whether a lattice is wanted of one class whose sites may go anywhere, or stay on lines, and
/// sites are many enough to begin with fewer.
[[nodiscard]] bool can_subdivide(const ClassProblem& problem, const ClassOptions& options);

/// Initial positions for patches of a lattice. A quarter of the sites is optimized first, itself
/// from a quarter of it, and so on down to a Poisson-disk set; then each edge between neighbors
/// gets a site at its middle, as in the subdivision of triangles by Loop (1987). A lattice becomes
/// a finer lattice and its defects do not multiply, so that patches are larger than any number of
/// steps from all sites at once would make them.
/// \pre can_subdivide(problem, options)
/// \throw Cancelled
[[nodiscard]] SubdividedStart subdivided_start(const ClassProblem& problem,
                                               const ClassOptions& options, Context* context);

}  // namespace dapple
