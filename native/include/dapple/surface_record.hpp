// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>

namespace dapple {

struct Connectivity;

/// The connectivity of faces as arrays, shared by all surfaces deformed from one. Faces and
/// vertices are in the surface's own order, except for the caller's indices in `original_face` and
/// `original_vertex`.
struct MeshRecord {
  std::optional<double> weld;  ///< see SurfaceOptions
  bool merge_doubled = true;   ///< see SurfaceOptions
  std::vector<Face> faces;
  std::vector<std::int32_t> original_face, original_vertex;
  std::vector<std::int32_t> next_around_edge;        ///< per half-edge, in rings
  std::vector<std::int32_t> welded_vertex;           ///< per vertex
  std::vector<std::int32_t> component;               ///< per face
  std::vector<std::int32_t> body;                    ///< per face, see Joints::bodies; or empty
  std::vector<std::array<std::int32_t, 5>> doubled;  ///< face, the one it lies on, its corners
};

/// A surface as plain data, for files and other processes; it can be restored exactly.
struct SurfaceRecord {
  std::shared_ptr<const Connectivity> connectivity;
  std::vector<Vec3> vertices;  ///< in the caller's order, as the density
  DensityAt density_at = DensityAt::kVertices;
  std::vector<double> density;  ///< empty if uniform
  double sharp_angle = 30.0;
  std::vector<std::uint8_t> hard_edges;  ///< per face one bit for each edge; in the surface's order
  std::vector<Vec3> normals;  ///< from with_normals(), three per face in that order; or empty
};

[[nodiscard]] MeshRecord record_of(const Connectivity& connectivity);
[[nodiscard]] SurfaceRecord record_of(const Surface& surface);

/// \throw ArgumentError naming the array of wrong length or the value out of range
[[nodiscard]] std::shared_ptr<const Connectivity> restored(MeshRecord record);

/// \throw ArgumentError naming the array of wrong length; SurfaceError as the constructor;
/// Cancelled
[[nodiscard]] Surface restored(const SurfaceRecord& record, Context* context = nullptr);

}  // namespace dapple
