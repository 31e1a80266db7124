// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>

#include "lines/feature_lines.hpp"
#include "remesh/site_editor.hpp"

namespace dapple {

/// The next surface of a sequence.
struct NextSurface {
  const Surface& surface;
  const FeatureLines& lines;
  double capacity;      ///< of a vertex: > 0
  double line_spacing;  ///< of vertices on lines, where the density is 1
};

/// The sites of the next surface's mesh, before they are optimized.
struct CarriedSites {
  RemeshSites sites;  ///< none if none of the vertices before has a place on the surface
  int evaluations = 0;
};

/// Vertices stay where the surface is the same around them. Others move with what they lie on, as
/// far as it is there. Lines get new ones between those that stay; elsewhere vertices go and come
/// until there are as many as the capacity asks for.
/// \param mesh of the surface before
/// \throw Cancelled
[[nodiscard]] CarriedSites carry_sites(const Surface& before, const RemeshResult& mesh,
                                       const NextSurface& next, const RemeshOptions& options,
                                       Context* context);

}  // namespace dapple
