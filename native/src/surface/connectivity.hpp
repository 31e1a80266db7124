// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <dapple/types.hpp>
#include <memory>
#include <optional>
#include <span>

#include "base/lazy.hpp"
#include "surface/doubled.hpp"

namespace dapple {

class FaceEdges;

/// Faces and vertices in their own order (along Morton curves, for the cache; *ordered* for short),
/// the maps to the caller's order, and which faces are neighbors. All surfaces deformed from one
/// share it.
struct Connectivity {
  std::optional<double> weld;                  // see SurfaceOptions
  std::vector<Face> faces;                     // ordered faces of ordered vertices
  std::vector<std::int32_t> original_face;     // ordered -> caller's
  std::vector<OrderedFace> ordered_face;       // caller's -> ordered
  std::vector<std::int32_t> original_vertex;   // ordered -> caller's
  std::vector<std::int32_t> next_around_edge;  // per half-edge, see OrderedSurface::next_around
  std::vector<std::int32_t> welded_vertex;     // per ordered vertex, see OrderedSurface::welded
  std::vector<std::int32_t> component;         // per ordered face; connected over edges
  std::int32_t components = 0;
  std::vector<std::int32_t> body;    // per ordered face, see Joints::bodies; empty: one
  bool merge_doubled = true;         // see SurfaceOptions
  std::vector<DoubledFace> doubled;  // sorted by face; each is in the component of the other
  std::shared_ptr<Lazy<FaceEdges>> face_edges =
      std::make_shared<Lazy<FaceEdges>>();  // see face_edges_of()
};

/// Connect faces over edges of the same vertices and, with `weld`, over border edges at the same
/// place (see SurfaceOptions::weld). \pre the faces' vertices exist. \throw Cancelled
[[nodiscard]] Connectivity connect(std::span<const Vec3> vertices, std::span<const Face> faces,
                                   std::optional<double> weld, bool merge_doubled,
                                   Context* context = nullptr);

/// Connect faces over the edges that the caller has identified.
/// \pre the faces' vertices exist, and the lengths match.
/// \throw Cancelled
[[nodiscard]] Connectivity connect(std::span<const Vec3> vertices, std::span<const Face> faces,
                                   const Joints& joints, bool merge_doubled,
                                   Context* context = nullptr);

}  // namespace dapple
