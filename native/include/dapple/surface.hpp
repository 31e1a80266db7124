// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <dapple/types.hpp>
#include <memory>
#include <optional>
#include <span>

namespace dapple {

/// Where the values of a density are given; on each face it is linear.
enum class DensityAt {
  kVertices,  ///< one per vertex: continuous over the surface
  kFaces,     ///< one per face: constant on it
  kCorners,   ///< three per face, of its corners 0, 1, 2: it may jump between faces
};

/// A density, with values in the caller's order; no values mean 1 everywhere.
struct Density {
  DensityAt at = DensityAt::kVertices;
  std::span<const double> values = {};
};

class Context;

/// How faces are connected and shaded.
struct SurfaceOptions {
  /// Weld distance, as a share of the bounding box's diagonal, >= 0: border edges whose ends are
  /// this close to each other are connected like one edge; 0 requires equal coordinates. Files
  /// repeat vertices along hard edges and texture seams, and triangle soups repeat all of them.
  /// Faces that lie on each other are not welded. None: faces are connected by the indices of their
  /// vertices alone.
  std::optional<double> weld = 1e-6;
  /// Edges whose faces' normals differ by more than this are hard: 0..180 degrees. Normals jump
  /// there, and are smooth over all other edges. Edges with one face or more than two are hard too.
  double sharp_angle = 30.0;
  /// Whether faces with the same three corners, of either orientation, count as one: the first of
  /// them. The others have no area, connect nothing and get no samples. Corners coincide if they
  /// are within `weld` of each other, or if their indices are equal. Faces that overlap in other
  /// ways are not changed.
  bool merge_doubled = true;
};

/// Which edges are connected and which vertices coincide, where the caller knows this better than
/// indices and coordinates tell.
struct Joints {
  std::span<const std::int32_t>
      edges;  ///< three per face, edge k from corner k to k + 1: equal numbers for connected edges
  std::span<const std::int32_t> places;  ///< per vertex: equal numbers for coincident vertices
  /// Per face: equal numbers for the faces of one body, where bodies are stuck into each other.
  /// Samples on different bodies keep their distance in space too, not only along the surface.
  /// Empty: one body.
  std::span<const std::int32_t> bodies = {};
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

  /// The same with known connections, wherever the vertices are. Corners coincide as `joints` says.
  /// \param normals as in with_normals(), or none
  /// \throw SurfaceError also if the lengths of `joints` do not fit or the angle is out of range,
  /// and as with_normals(); Cancelled
  Surface(std::span<const Vec3> vertices, std::span<const Face> faces, const Density& density,
          const Joints& joints, double sharp_angle = SurfaceOptions{}.sharp_angle,
          bool merge_doubled = SurfaceOptions{}.merge_doubled, Context* context = nullptr,
          std::span<const Vec3> normals = {});

  /// The same faces and density over moved vertices (as many, in the same order). Hard edges stay
  /// hard, whatever their angle is now; if a vertex moves, normals from with_normals() are dropped.
  /// \throw SurfaceError as the constructor; Cancelled
  [[nodiscard]] Surface deformed(std::span<const Vec3> vertices, Context* context = nullptr) const;

  /// The same faces and vertices, shared, with another density.
  /// \throw SurfaceError as the constructor; Cancelled
  [[nodiscard]] Surface with_density(const Density& density, Context* context = nullptr) const;

  /// The same surface, shaded with these normals, such as custom normals or those of a file. Edges
  /// where they jump are hard, also in surfaces deformed from it.
  /// \param corners three per face, at its corners, of any length; zero where none is known
  /// \throw SurfaceError if their number is wrong; naming the first that is not finite
  [[nodiscard]] Surface with_normals(std::span<const Vec3> corners) const;

  [[nodiscard]] std::size_t vertex_count() const;
  [[nodiscard]] std::size_t face_count() const;
  /// Number of faces that do not count because they lie on others (SurfaceOptions::merge_doubled).
  [[nodiscard]] std::size_t doubled_faces() const;
  [[nodiscard]] bool merge_doubled() const;  ///< see SurfaceOptions
  [[nodiscard]] double area() const;         ///< in squares of the vertices' unit
  [[nodiscard]] double capacity() const;     ///< integral of the density over the surface
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
  /// Faces with welded vertices merged (SurfaceOptions::weld).
  [[nodiscard]] std::vector<Face> welded_faces() const;
  [[nodiscard]] std::vector<double> density() const;  ///< as given; empty if uniform

  /// The caller's indices of the faces' vertices, with one of each group of welded vertices.
  [[nodiscard]] std::vector<std::int32_t> distinct_vertices() const;

  /// Move points from faces that do not count to the faces that they lie on.
  /// \param faces   the caller's
  /// \param weights barycentric coordinates, one for each face
  /// \pre the faces are in 0..face_count() - 1, and the lengths are equal
  void move_to_counted(std::span<std::int32_t> faces, std::span<Vec3> weights) const;

  /// The point of the caller's face `face` with barycentric coordinates `weights`.
  /// \pre face is in 0..face_count() - 1; the weights' sum is 1
  [[nodiscard]] Vec3 point(std::int32_t face, const Vec3& weights) const;

  /// Unit shading normals at the corners of the caller's faces, three per face: the given ones,
  /// elsewhere the mean over the surrounding faces that no hard edge separates from this one,
  /// weighted by their angles (Thuermer and Wuethrich 1998).
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

  /// Number of samples with this distance between neighbors where the density is largest, if they
  /// are packed hexagonally: 2 C / (sqrt(3) spacing^2) to the nearest, at least 1, where C is the
  /// capacity divided by the largest density. With one density everywhere C is the area, and this
  /// is the inverse of spacing().
  /// \throw ArgumentError if the spacing is not finite and > 0, or for more than kMostSamples
  [[nodiscard]] std::size_t count(double spacing) const;

  /// For the library's own algorithms; this header is not installed.
  [[nodiscard]] const OrderedSurface& ordered() const { return *ordered_; }

 private:
  friend Surface restored(const SurfaceRecord& record, Context* context);
  explicit Surface(std::shared_ptr<const OrderedSurface> ordered) : ordered_(std::move(ordered)) {}

  [[nodiscard]] std::vector<Vec3> counted_normals(std::span<const std::int32_t> faces,
                                                  std::span<const Vec3> weights) const;

  std::shared_ptr<const OrderedSurface> ordered_;
};

}  // namespace dapple
