// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>

namespace dapple {

struct Connectivity;

/// How faces are connected, as arrays. Surfaces that are deformed from one share it. Faces and
/// vertices are in the surface's own order but for the `original` ones, the caller's indices.
struct MeshRecord {
  std::optional<double> weld;  ///< see SurfaceOptions
  bool merge_doubled = true;   ///< see SurfaceOptions
  std::vector<Face> faces;
  std::vector<std::int32_t> original_face, original_vertex;
  std::vector<std::int32_t> next_around_edge;        ///< per half-edge, in rings
  std::vector<std::int32_t> welded_vertex;           ///< per vertex
  std::vector<std::int32_t> component;               ///< per face
  std::vector<std::array<std::int32_t, 5>> doubled;  ///< face, the one it lies on, its corners
};

/// What a surface is, for files and other processes: it comes back to the last byte.
struct SurfaceRecord {
  std::shared_ptr<const Connectivity> connectivity;
  std::vector<Vec3> vertices;  ///< in the caller's order, as the density
  DensityAt density_at = DensityAt::kVertices;
  std::vector<double> density;  ///< empty if uniform
  double sharp_angle = 30.0;
  std::vector<std::uint8_t> hard_edges;  ///< per face a bit for each edge; in the surface's order
  std::vector<Vec3> normals;  ///< that were given, three per face in that order; or empty
};

[[nodiscard]] MeshRecord record_of(const Connectivity& connectivity);
[[nodiscard]] SurfaceRecord record_of(const Surface& surface);

/// \throw ArgumentError naming what is of another length or out of range
[[nodiscard]] std::shared_ptr<const Connectivity> restored(MeshRecord record);

/// \throw ArgumentError naming what is of another length; SurfaceError as the constructor;
/// Cancelled
[[nodiscard]] Surface restored(const SurfaceRecord& record, Context* context = nullptr);

}  // namespace dapple
