// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <dapple/types.hpp>
#include <optional>

namespace dapple {

/// A convex polyhedron in space that shrinks as half-spaces cut it: the Voronoi cell of a site
/// within a box. It is kept a little too large, so that what does not reach into it cuts nothing
/// off the cell.
///
/// Each vertex lies on three planes, and two vertices that share two of these are joined by an edge
/// (as in Sainlot, Nivoliers and Attali, "Restricting Voronoi diagrams to meshes using corner
/// validation", 2017: only corners need to be looked at).
class CellPolyhedron {
 public:
  /// Begin with a box; all that is cut lies in it.
  void start(const Eigen::AlignedBox3d& box);

  /// Whether a part of it lies in x . normal > offset, rounding aside.
  [[nodiscard]] bool is_cut_by(const Vec3& normal, double offset) const;

  /// Whether it has a vertex in the plane x . normal = offset, rounding aside, or beyond.
  [[nodiscard]] bool touches(const Vec3& normal, double offset) const;

  /// Keep the part with x . normal <= offset. False if rounding leaves no polyhedron: then nothing
  /// is known any more.
  [[nodiscard]] bool cut(const Vec3& normal, double offset);

  /// A vertex that was not given out before; none if all were.
  [[nodiscard]] std::optional<Vec3> next_vertex();

 private:
  struct Vertex {
    Vec3 x;
    std::array<std::int32_t, 3> planes;
    bool given_out;
    double side;  // of the plane that cuts at the moment
  };

  void cross(const Vertex& outside, const Vertex& inside);
  [[nodiscard]] bool closes_up() const;

  std::vector<Vertex> vertices_, fresh_;
  std::int32_t planes_ = 0;
  double slack_ = 0.0;  // a length
};

}  // namespace dapple
