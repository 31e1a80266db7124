// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>
#include <dapple/remesh.hpp>

namespace dapple {

/// Vertices of a mesh around which the next surface is the same as the one before.
struct Unchanged {
  std::vector<bool> vertices;  ///< per vertex
  Projection places;           ///< of all vertices, on the next surface
};

/// A vertex is unchanged if no change of the surface is within its neighbors' cells: a vertex or a
/// middle of a face of either surface that is farther from the other, or whose density differs.
/// \param tolerance the largest distance that is no change
/// \throw Cancelled
[[nodiscard]] Unchanged unchanged_vertices(const Surface& before, const RemeshResult& mesh,
                                           const Surface& next, double tolerance,
                                           const Context* context);

}  // namespace dapple
