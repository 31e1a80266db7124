// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

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

/// Joins the pieces of a cell where they meet along edges of the mesh.
class PatchBuilder {
 public:
  /// \param vertices, faces of the surface, in the caller's order and welded; they must outlive the
  /// builder
  PatchBuilder(std::span<const Vec3> vertices, std::span<const Face> faces)
      : vertices_(vertices), faces_(faces) {}

  /// Pieces share what lies on the same vertex of the mesh, or on the same edge of it and the same
  /// plane; a point that rounding put on one side of an edge only is added to the other. No edge
  /// is shorter than `tolerance`; polygons without extent are gone, and no polygon meets itself.
  [[nodiscard]] Patch build(std::span<const CellPolygon> pieces, double tolerance) const;

 private:
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
};

}  // namespace dapple
