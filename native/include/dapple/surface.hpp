// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <memory>
#include <optional>
#include <span>

namespace dapple {

/// Integrals over a region of the surface, relative to a reference point o; phi is the density.
struct Moments {
  double area = 0.0;
  double capacity = 0.0;      ///< integral of phi
  double mass = 0.0;          ///< integral of phi^2
  Vec3 first = Vec3::Zero();  ///< integral of phi^2 (x - o)
  double second = 0.0;        ///< integral of phi^2 |x - o|^2
};

/// What the algorithms need to know of one face.
struct FaceGeometry {
  Vec3 normal = Vec3::Zero();            ///< unit; zero for a face without area
  Vec3 density_gradient = Vec3::Zero();  ///< of the linear density, in the face's plane
  Vec3 centroid = Vec3::Zero();
  Moments moments;  ///< of the whole face, relative to its centroid
};

/// Where values of a density are given; on each face it is linear.
enum class DensityAt {
  kVertices,  ///< one per vertex: continuous over the surface
  kFaces,     ///< one per face: constant on it
  kCorners,   ///< three per face, of its corners 0, 1, 2: it may jump between faces
};

/// A wanted density as a caller gives it, in the caller's order; no values mean 1 everywhere.
struct Density {
  DensityAt at = DensityAt::kVertices;
  std::span<const double> values = {};
};

/// How a surface is put together.
struct SurfaceOptions {
  /// Border edges whose ends are within this distance of each other, as a share of the bounding
  /// box's diagonal, are connected like one edge: >= 0, where 0 asks for equal coordinates. Files
  /// repeat vertices along hard edges and texture seams; triangle soups repeat all of them. Faces
  /// that lie on each other stay apart. None: faces are connected by the indices of their vertices
  /// alone.
  std::optional<double> weld = 1e-6;
};

/// Which edges are one and which vertices are at one place, where somebody knows better than their
/// indices and coordinates tell.
struct Joints {
  std::span<const std::int32_t> edges;  ///< per face three, from its corner k on: equal if one edge
  std::span<const std::int32_t> places;  ///< per vertex: equal if at one place
};

/// How the faces hang together, shared by all surfaces deformed from one.
struct SurfaceConnectivity {
  std::optional<double> weld;                  // see SurfaceOptions
  std::vector<Face> faces;                     // ordered faces of ordered vertices
  std::vector<std::int32_t> original_face;     // ordered -> caller's
  std::vector<std::int32_t> ordered_face;      // caller's -> ordered
  std::vector<std::int32_t> original_vertex;   // ordered -> caller's
  std::vector<std::int32_t> next_around_edge;  // per half-edge, see Surface::next_around
  std::vector<std::int32_t> welded_vertex;     // per ordered vertex, see Surface::welded
  std::vector<std::int32_t> component;         // per ordered face; connected over edges
  std::int32_t components = 0;
};

/// The density in the surface's own order.
struct SurfaceDensity {
  DensityAt at = DensityAt::kVertices;
  std::vector<double> values;  // empty if uniform
};

/// What follows from positions and density; in the surface's own order.
struct SurfaceGeometry {
  std::vector<FaceGeometry> faces;  // of the density times the unit
  double area = 0.0;
  double mass = 0.0;          // the caller's
  double density_unit = 1.0;  // see Surface::density_unit
};

/// Immutable, checked triangles with a density that is linear on each face.
///
/// Faces and vertices are kept in a cache-friendly (Morton) order of its own, called *ordered*
/// here; everything else in the library speaks of the caller's indices. Copies share everything.
class Surface {
 public:
  /// \param vertices positions, in any unit
  /// \param faces    vertex indices; degenerate, repeated and non-manifold faces are allowed
  /// \param density  one value per vertex, >= 0; empty means 1 everywhere
  /// \throw SurfaceError naming the first offender: an index out of range, a number that is not
  /// finite, a negative
  ///        density, a density array of another length, or no area (or no density) at all
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
          std::span<const double> density = {});

  /// The same with a density at vertices, faces or corners (as many values >= 0 as there are).
  /// \throw SurfaceError also if `options.weld` is negative or not finite
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces, const Density& density,
          const SurfaceOptions& options = {});

  /// The same with connections that are known, wherever the vertices are.
  /// \throw SurfaceError also if the lengths of `joints` do not fit
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces, const Density& density,
          const Joints& joints);

  /// The same faces and density over moved vertices (as many, in the same order).
  /// \throw SurfaceError as the constructor
  [[nodiscard]] Surface deformed(std::span<const Vec3> vertices) const;

  /// The same faces and vertices, shared, with another density.
  /// \throw SurfaceError as the constructor
  [[nodiscard]] Surface with_density(const Density& density) const;

  [[nodiscard]] std::size_t vertex_count() const { return vertices_->size(); }
  [[nodiscard]] std::size_t face_count() const { return connectivity_->faces.size(); }
  [[nodiscard]] double area() const { return geometry_->area; }
  [[nodiscard]] double mass() const {
    return geometry_->mass;
  }  ///< integral of the density over the surface
  /// Whether one was made from the other by deformed() or with_density().
  [[nodiscard]] bool same_faces(const Surface& other) const {
    return connectivity_ == other.connectivity_;
  }
  [[nodiscard]] std::optional<double> weld() const { return connectivity_->weld; }
  [[nodiscard]] bool uniform() const { return density_->values.empty(); }
  [[nodiscard]] DensityAt density_at() const { return density_->at; }

  /// Copies in the caller's order.
  [[nodiscard]] std::vector<Vec3> vertices() const;
  [[nodiscard]] std::vector<Face> faces() const;
  /// With one vertex in the place of all that hang together (SurfaceOptions::weld).
  [[nodiscard]] std::vector<Face> welded_faces() const;
  [[nodiscard]] std::vector<double> density() const;  ///< as given; empty if uniform

  /// The caller's indices of the vertices, of those that hang together only one.
  [[nodiscard]] std::vector<std::int32_t> distinct_vertices() const;

  /// The point of the caller's face `face` with barycentric coordinates `weights`.
  [[nodiscard]] Vec3 point(std::int32_t face, const Vec3& weights) const;

  /// Unit normals at points of the surface, interpolated from angle-weighted vertex normals.
  [[nodiscard]] std::vector<Vec3> normals(std::span<const std::int32_t> faces,
                                          std::span<const Vec3> weights) const;

  /// Distance between neighbours if n points were packed hexagonally: sqrt(2 A / (sqrt(3) n)).
  [[nodiscard]] double spacing(std::size_t count) const;

  /// What `geometry` and domains have multiplied the density by: 1, unless the mean density lies
  /// beyond 2^64 or 2^-64; then the power of two that brings it near 1, so that squares of
  /// integrals stay in the range of numbers.
  [[nodiscard]] double density_unit() const { return geometry_->density_unit; }

  // The ordered view, for the algorithms.
  [[nodiscard]] std::int32_t ordered_face(std::int32_t face) const {
    return connectivity_->ordered_face[static_cast<std::size_t>(face)];
  }
  [[nodiscard]] std::int32_t original_face(std::int32_t ordered) const {
    return connectivity_->original_face[static_cast<std::size_t>(ordered)];
  }
  /// Ordered vertices of an ordered face.
  [[nodiscard]] const Face& corners(std::int32_t ordered) const {
    return connectivity_->faces[static_cast<std::size_t>(ordered)];
  }
  [[nodiscard]] const Vec3& vertex(std::int32_t ordered) const {
    return (*vertices_)[static_cast<std::size_t>(ordered)];
  }
  /// The density at the corners of an ordered face; it is linear in between.
  [[nodiscard]] Vec3 densities(std::int32_t ordered) const;
  [[nodiscard]] const FaceGeometry& geometry(std::int32_t ordered) const {
    return geometry_->faces[static_cast<std::size_t>(ordered)];
  }
  /// Sets of faces connected over edges; `component(ordered face)` is in 0..components() - 1.
  [[nodiscard]] std::int32_t components() const { return connectivity_->components; }
  [[nodiscard]] std::int32_t component(std::int32_t ordered) const {
    return connectivity_->component[static_cast<std::size_t>(ordered)];
  }
  /// The lowest ordered vertex that an ordered one hangs together with over connected edges.
  [[nodiscard]] std::int32_t welded(std::int32_t vertex) const {
    return connectivity_->welded_vertex[static_cast<std::size_t>(vertex)];
  }
  /// The corners of an ordered face as welded vertices.
  [[nodiscard]] Face welded_corners(std::int32_t ordered) const {
    const auto [a, b, c] = corners(ordered);
    return {welded(a), welded(b), welded(c)};
  }
  /// The next half-edge around the edge of `half_edge` (3 * ordered face + corner it starts from):
  /// the other side of an inner edge, itself on a border, the next of a ring where three or more
  /// faces meet.
  [[nodiscard]] std::int32_t next_around(std::int32_t half_edge) const {
    return connectivity_->next_around_edge[static_cast<std::size_t>(half_edge)];
  }

 private:
  void measure();
  template <typename Corners>
  [[nodiscard]] std::vector<Face> original_faces(const Corners& corners_of) const;
  [[nodiscard]] double find_density_unit() const;
  [[nodiscard]] std::vector<double> corner_angles(std::span<const std::int32_t> of) const;

  std::shared_ptr<const SurfaceConnectivity> connectivity_;
  std::shared_ptr<const std::vector<Vec3>> vertices_;
  std::shared_ptr<const SurfaceDensity> density_;
  std::shared_ptr<const SurfaceGeometry> geometry_;
};

}  // namespace dapple
