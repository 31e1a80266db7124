// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/density.hpp>
#include <memory>
#include <optional>
#include <span>

namespace dapple {

class Context;

/// How a surface is put together.
struct SurfaceOptions {
  /// Border edges whose ends are within this distance of each other, as a share of the bounding
  /// box's diagonal, are connected like one edge: >= 0, where 0 asks for equal coordinates. Files
  /// repeat vertices along hard edges and texture seams; triangle soups repeat all of them. Faces
  /// that lie on each other stay apart. None: faces are connected by the indices of their vertices
  /// alone.
  std::optional<double> weld = 1e-6;
  /// Edges whose faces' normals differ by more than this are hard: 0..180 degrees. Normals jump
  /// there, and are smooth over all other edges. Edges with one face or more than two are hard too.
  double sharp_angle = 30.0;
  /// Whether faces that lie on each other corner by corner, turned the same way or not, count as
  /// one: the first of them. The others have no area, connect nothing, and get no samples. Corners
  /// are at one place as `weld` says, or if their indices are equal. Faces that overlap in another
  /// way stay as they are.
  bool merge_doubled = true;
};

/// Which edges are one and which vertices are at one place, where somebody knows better than their
/// indices and coordinates tell.
struct Joints {
  std::span<const std::int32_t> edges;  ///< per face three, from its corner k on: equal if one edge
  std::span<const std::int32_t> places;  ///< per vertex: equal if at one place
};

class OrderedSurface;
struct SurfaceRecord;

/// Immutable, checked triangles with a density that is linear on each face.
///
/// All indices are the caller's. Copies share everything.
class Surface {
 public:
  /// \param vertices positions, in any unit
  /// \param faces    vertex indices; degenerate, repeated and non-manifold faces are allowed
  /// \param density  one value per vertex, >= 0; empty means 1 everywhere
  /// \throw SurfaceError naming the first offender: an index out of range, a number that is not
  /// finite, a negative density, a density array of another length, no area, or a density whose
  /// integral is 0 or not finite
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
          std::span<const double> density = {});

  /// The same with a density at vertices, faces or corners (as many values >= 0 as there are).
  /// \throw SurfaceError also if an option is out of its range; Cancelled
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces, const Density& density,
          const SurfaceOptions& options = {}, Context* context = nullptr);

  /// The same with connections that are known, wherever the vertices are. Corners are at one place
  /// as `joints` says.
  /// \throw SurfaceError also if the lengths of `joints` do not fit or the angle is out of range;
  /// Cancelled
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces, const Density& density,
          const Joints& joints, double sharp_angle = SurfaceOptions{}.sharp_angle,
          bool merge_doubled = SurfaceOptions{}.merge_doubled, Context* context = nullptr);

  /// The same faces and density over moved vertices (as many, in the same order). Hard edges stay
  /// hard, whatever their angle is now; normals that were given are not kept.
  /// \throw SurfaceError as the constructor; Cancelled
  [[nodiscard]] Surface deformed(std::span<const Vec3> vertices, Context* context = nullptr) const;

  /// The same faces and vertices, shared, with another density.
  /// \throw SurfaceError as the constructor; Cancelled
  [[nodiscard]] Surface with_density(const Density& density, Context* context = nullptr) const;

  /// The same surface, shaded as these normals say: those of custom normals, or of a file. Where
  /// they jump, edges are hard, also in what is deformed from it.
  /// \param corners three per face, at its corners, of any length; zero where none is known
  /// \throw SurfaceError if their number is another; naming the first that is not finite
  [[nodiscard]] Surface with_normals(std::span<const Vec3> corners) const;

  [[nodiscard]] std::size_t vertex_count() const;
  [[nodiscard]] std::size_t face_count() const;
  /// How many faces do not count because they lie on others (SurfaceOptions::merge_doubled).
  [[nodiscard]] std::size_t doubled_faces() const;
  [[nodiscard]] bool merge_doubled() const;  ///< see SurfaceOptions
  [[nodiscard]] double area() const;         ///< in squares of the vertices' unit
  [[nodiscard]] double mass() const;         ///< integral of the density over the surface
  /// Whether one was made from the other by deformed() or with_density().
  [[nodiscard]] bool same_faces(const Surface& other) const;
  [[nodiscard]] std::optional<double> weld() const;  ///< see SurfaceOptions
  [[nodiscard]] double sharp_angle() const;          ///< in degrees, see SurfaceOptions
  [[nodiscard]] bool has_normals() const;            ///< whether with_normals() gave some
  [[nodiscard]] bool uniform() const;                ///< whether no density was given
  [[nodiscard]] DensityAt density_at() const;

  /// Copies in the caller's order.
  [[nodiscard]] std::vector<Vec3> vertices() const;
  [[nodiscard]] std::vector<Face> faces() const;
  /// With one vertex in the place of all that hang together (SurfaceOptions::weld).
  [[nodiscard]] std::vector<Face> welded_faces() const;
  [[nodiscard]] std::vector<double> density() const;  ///< as given; empty if uniform

  /// The caller's indices of the faces' vertices, of those that hang together only one.
  [[nodiscard]] std::vector<std::int32_t> distinct_vertices() const;

  /// Move points from faces that do not count to those that they lie on.
  /// \param faces   the caller's
  /// \param weights barycentric coordinates, one for each face
  /// \pre the faces are in 0..face_count() - 1, and the lengths are equal
  void move_to_counted(std::span<std::int32_t> faces, std::span<Vec3> weights) const;

  /// The point of the caller's face `face` with barycentric coordinates `weights`.
  /// \pre face is in 0..face_count() - 1; the weights' sum is 1
  [[nodiscard]] Vec3 point(std::int32_t face, const Vec3& weights) const;

  /// Unit normals at the corners of the caller's faces, three per face, as the surface is shaded:
  /// those that are given, elsewhere the mean of the faces around that no hard edge separates from
  /// this one, weighted by their angles (Thuermer and Wuethrich 1998).
  [[nodiscard]] std::vector<Vec3> corner_normals() const;

  /// Unit normals at points, interpolated from those at the corners; z if there are none.
  /// \param faces   the caller's
  /// \param weights barycentric coordinates, one for each face
  /// \throw ArgumentError naming the first face out of range; if the lengths differ
  [[nodiscard]] std::vector<Vec3> normals(std::span<const std::int32_t> faces,
                                          std::span<const Vec3> weights) const;

  /// Distance between neighbors if n points were packed hexagonally, sqrt(2 A / (sqrt(3) n)), in
  /// the vertices' unit; a count of 0 is taken as 1.
  [[nodiscard]] double spacing(std::size_t count) const;

  /// For the library's own algorithms, whose headers are not installed.
  [[nodiscard]] const OrderedSurface& ordered() const { return *ordered_; }

 private:
  friend Surface restored(const SurfaceRecord& record, Context* context);
  explicit Surface(std::shared_ptr<const OrderedSurface> ordered) : ordered_(std::move(ordered)) {}

  [[nodiscard]] std::vector<Vec3> counted_normals(std::span<const std::int32_t> faces,
                                                  std::span<const Vec3> weights) const;

  std::shared_ptr<const OrderedSurface> ordered_;
};

}  // namespace dapple
