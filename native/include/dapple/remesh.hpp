// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/context.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/surface.hpp>
#include <vector>

namespace dapple {

/// What becomes of edges with three or more faces, and of vertices where faces touch at a point
/// alone.
enum class NonManifold {
  kKept,  ///< they stay as they are
  kCut,   ///< the faces around them are cut apart, each part with vertices of its own
};

/// Settings of the optimizer that end near a hexagonal lattice, which gives the best triangles.
[[nodiscard]] inline OptimizerOptions lattice_options() {
  OptimizerOptions options;
  options.capacity_weight = 0.3;
  options.repulsion_weight = 0.0;
  options.tolerance = 5e-4;
  options.max_evaluations = 80;
  return options;
}

struct RemeshOptions {
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;  // basic, >= 0
  /// Edges whose faces' normals differ by more than this are creases, which stay, and so do their
  /// corners; 180 keeps none.
  double feature_angle = 30.0;  // basic, 0..180, degrees
  /// Largest distance of the new mesh from the surface, and of the surface from it: vertices are
  /// added until no vertex and no middle of an edge or face is farther away. 0 sets no limit.
  double max_distance = 0.0;  // basic, >= 0
  /// Vertices are closer together where the mesh would be far from the surface: about half of the
  /// largest distance with as many vertices. It takes about five times as long.
  bool adaptive = false;  // basic
  /// Edges with three or more faces stay as they are, or the faces around them are cut apart.
  NonManifold non_manifold = NonManifold::kKept;   // expert
  OptimizerOptions optimizer = lattice_options();  // options
  /// Owner of a part of the surface: the nearest site that it is connected to along the surface, or
  /// the nearest site in space as in the paper.
  Cells cells = Cells::kConnected;  // expert
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Edges that stay besides creases and borders, each by the indices of its two vertices.
  std::vector<std::array<std::int32_t, 2>> edges = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const RemeshOptions& options);

/// Where a vertex of a remesh lies on the old surface.
enum class VertexFeature : std::int32_t {
  kFace,    ///< within it
  kLine,    ///< on a crease, a border or a marked edge
  kCorner,  ///< where such lines end, meet or turn: a vertex of the old surface
};

/// The quality of a remesh.
struct RemeshReport {
  std::size_t asked = 0;     ///< vertices asked for
  std::size_t vertices = 0;  ///< vertices made: more where the topology needs them
  std::size_t faces = 0;
  std::size_t on_lines = 0;  ///< vertices on lines, corners included
  std::size_t corners = 0;
  /// Creases that were given up because no mesh of the topology was found with them, such as two
  /// that touch along their way.
  std::size_t dropped_lines = 0;
  double smallest_angle = 0.0;       ///< of all triangles, in degrees
  double mean_smallest_angle = 0.0;  ///< mean of the triangles' smallest angles, in degrees
  double below_30 = 0.0;             ///< share of triangles with an angle below 30 degrees
  double valence_6 = 0.0;   ///< share of vertices with six neighbors, apart from those on lines
  std::size_t flipped = 0;  ///< triangles that face away from the old surface
  /// Triangles that pass through others with which they have no vertex in common.
  std::size_t self_intersecting = 0;
  std::size_t nonmanifold_edges = 0;
  std::int32_t euler = 0;         ///< vertices - edges + faces
  std::int32_t border_loops = 0;  ///< -1 if not manifold
  /// Places where the cells of the vertices still break the topology of the surface; 0 means that
  /// the new mesh has the topology of the old one.
  std::size_t flaws = 0;
  /// The largest distance that `max_distance` limits; 0 without a limit, if not `adaptive`.
  double distance = 0.0;
  int evaluations = 0;
  bool converged = true;
  double seconds = 0.0;  ///< wall time
  Profile profile;       ///< by stage; sums to `seconds`
};

/// A triangle mesh whose vertices lie on the surface that it is made from.
struct RemeshResult {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;                 ///< oriented like the surface
  std::vector<std::int32_t> source_faces;  ///< per vertex: the caller's face that it lies on
  std::vector<Vec3> barycentric;           ///< per vertex: in that face; >= 0, sum 1
  std::vector<VertexFeature> features;     ///< per vertex
  std::vector<std::array<std::int32_t, 2>> lines;  ///< edges along lines, the lower vertex first
  /// With `adaptive`, the density that the vertices follow: three values per face of the surface,
  /// of its corners. Empty where it is the surface's own.
  std::vector<double> density;
  RemeshReport report;
};

/// The best triangle mesh of `count` vertices: the dual of the restricted Voronoi diagram of sites
/// that are spaced evenly, by the surface's density (Yan et al. 2009). Vertices lie on the surface.
///
/// Borders, creases and marked edges stay: their corners are vertices, and vertices along them are
/// spaced like the others. The mesh has the topology of the surface once every cell is a disc and
/// any two of them meet along one curve (closed ball property, Edelsbrunner and Shah 1997). Where
/// that fails sites are added, and as many are taken away elsewhere. Thin triangles are made wider
/// in the end, where lines leave room. Vertices are more than `count` only where the topology, or
/// `max_distance`, needs more; the report tells.
/// \throw ArgumentError for options out of range, a count of 0, or naming the first of `edges` that
///        is no edge; Cancelled
[[nodiscard]] RemeshResult remesh(const Surface& surface, std::size_t count,
                                  const RemeshOptions& options = {}, Context* context = nullptr);

/// The remesh of the next surface of a sequence.
struct NextRemesh {
  RemeshResult mesh;
  /// Per vertex, the vertex of the mesh before that it was; -1 for a new one.
  std::vector<std::int32_t> previous;
  std::size_t kept = 0;  ///< vertices that have not moved, because the surface around is the same
};

/// Remesh the next surface of a sequence, whose faces may be others: fluids, torn, carved and built
/// bodies. Where the surface is the same as before, vertices stay exactly where they are. Others
/// move along with it, each to the nearest place on its side that is not far; where surface appears
/// or is gone, vertices come and go. The spacing is that of the first mesh: the number of vertices
/// changes with the area.
/// \param before   the surface that `mesh` is made from
/// \param capacity of a vertex: that of the first surface, divided by the number of its vertices
/// \param options  `adaptive` must be off and `non_manifold` kKept; `edges` are the next surface's
/// \throw ArgumentError as remesh(), if the mesh is not of the surface before, or for a capacity
///        that is not > 0; Cancelled
[[nodiscard]] NextRemesh remesh_next(const Surface& before, const RemeshResult& mesh,
                                     const Surface& next, double capacity,
                                     const RemeshOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
