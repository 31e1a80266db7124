// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <vector>

namespace dapple {

/// The connectivity of a surface's faces, which is measured without changing them.
struct Topology {
  std::int32_t components = 0;         ///< sets of faces connected over edges
  std::int32_t border_edges = 0;       ///< edges with one face
  std::int32_t border_loops = 0;       ///< closed chains of border edges; -1 if not manifold
  std::int32_t nonmanifold_edges = 0;  ///< edges with three or more faces
  bool manifold =
      false;  ///< every edge and vertex has a disc or half-disc around it, consistently oriented
  bool closed = false;      ///< manifold without border
  std::int32_t genus = -1;  ///< handles, summed over the components; -1 if not manifold
};

/// Measure the topology, with coincident border edges connected (SurfaceOptions::weld).
/// Manifoldness, borders and genus come from OpenMesh's half-edge mesh; counts that must also hold
/// for non-manifold input come from the surface's own adjacency.
[[nodiscard]] Topology topology(const Surface& surface);

/// The island of each face: faces that are connected over edges with density. Samples do not move
/// from one island to another, so each has a whole number of them.
/// \return one number per face, the caller's index, from 0 in the order of the first faces; -1 for
///         faces without area or density and for doubled ones
[[nodiscard]] std::vector<std::int32_t> islands(const Surface& surface);

}  // namespace dapple
