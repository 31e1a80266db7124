// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <map>
#include <utility>
#include <vector>

namespace dapple {

/// A polygon by the indices of its vertices, counter-clockwise.
struct PatchPolygon {
  std::vector<std::int32_t> corners;
  std::int32_t face;  ///< the caller's face that it lies on
};

/// A part of a surface as polygons that share vertices.
struct Patch {
  std::vector<Vec3> points;
  std::vector<PatchPolygon> polygons;
};

/// The feature that a vertex of a patch lies on; if two vertices are merged, the stronger feature
/// stays.
enum class On : std::uint8_t { kVertex, kEdge, kFace };

/// A patch made by joining pieces.
struct JoinedPatch {
  Patch patch;
  std::vector<On> kinds;  ///< per point
};

/// Remove edges shorter than `shortest` and polygons without extent; no polygon meets itself
/// afterward.
[[nodiscard]] Patch without_short_edges(JoinedPatch joined, double shortest);

/// The same for adjacent patches, which stay adjacent with identical points: an edge is removed
/// from all patches that share it, to the same place. Points within `rounding` count as one.
[[nodiscard]] std::vector<Patch> without_short_edges(std::vector<JoinedPatch> joined,
                                                     double shortest, double rounding);

/// Points on edges of the mesh, keyed by the vertices of the edge, the lower first.
using EdgePoints = std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Vec3>>;

/// Joins the pieces of a cell where they meet along edges of the mesh.
class PatchBuilder {
 public:
  /// \param vertices, faces of the surface, in the caller's order and welded; they must outlive the
  /// builder
  PatchBuilder(std::span<const Vec3> vertices, std::span<const Face> faces)
      : vertices_(vertices), faces_(faces) {}

  /// Pieces share points on the same vertex of the mesh, or on the same edge and the same plane; a
  /// point that rounding placed on only one side of an edge is added to the other. No polygon meets
  /// itself.
  /// \param others  points that also become corners where edges of pieces pass through them
  [[nodiscard]] JoinedPatch build(std::span<const CellPolygon> pieces,
                                  const EdgePoints& others = {}) const;

  /// The corners of pieces that lie on edges of the mesh.
  [[nodiscard]] EdgePoints edge_points(std::span<const CellPolygon> pieces) const;

 private:
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
};

}  // namespace dapple
