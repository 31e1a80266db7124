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

/// What a vertex of a patch lies on; of two that become one the stronger stays.
enum class On : std::uint8_t { kVertex, kEdge, kFace };

/// A patch as its pieces were joined.
struct JoinedPatch {
  Patch patch;
  std::vector<On> kinds;  ///< per point
};

/// Without edges shorter than `shortest`; polygons without extent are gone, and no polygon meets
/// itself.
[[nodiscard]] Patch without_short_edges(JoinedPatch joined, double shortest);

/// The same of patches that touch, so that they touch with the same points as before: an edge is
/// removed from all that have it, to the same place. Points within `rounding` count as one.
[[nodiscard]] std::vector<Patch> without_short_edges(std::vector<JoinedPatch> joined,
                                                     double shortest, double rounding);

/// Points on edges of the mesh, by the vertices of these, the lower first.
using EdgePoints = std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Vec3>>;

/// Joins the pieces of a cell where they meet along edges of the mesh.
class PatchBuilder {
 public:
  /// \param vertices, faces of the surface, in the caller's order and welded; they must outlive the
  /// builder
  PatchBuilder(std::span<const Vec3> vertices, std::span<const Face> faces)
      : vertices_(vertices), faces_(faces) {}

  /// Pieces share what lies on the same vertex of the mesh, or on the same edge of it and the same
  /// plane; a point that rounding put on one side of an edge only is added to the other. No polygon
  /// meets itself.
  /// \param others  points that become corners too where edges of the pieces run over them
  [[nodiscard]] JoinedPatch build(std::span<const CellPolygon> pieces,
                                  const EdgePoints& others = {}) const;

  /// Where corners of pieces lie on edges of the mesh.
  [[nodiscard]] EdgePoints edge_points(std::span<const CellPolygon> pieces) const;

 private:
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
};

}  // namespace dapple
