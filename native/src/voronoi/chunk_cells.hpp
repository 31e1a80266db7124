// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surface/integrate.hpp"
#include "voronoi/face_arcs.hpp"

namespace dapple {

/// What a chunk of faces contributes to a cell, relative to its site.
struct CellPart {
  std::int32_t site;
  std::uint64_t pieces = 0;  ///< the sum of mark_of() over the faces whose border it meets
  Integrals sum = {};
};

/// Numbers whose sum tells, but for a coincidence, whether two sets of faces are equal.
inline std::uint64_t mark_of(OrderedFace face) {
  return (std::uint64_t{1} << 40) + static_cast<std::uint64_t>(face);
}

/// What a chunk of faces contributes to the boundary between two cells.
struct BoundaryPart {
  std::int32_t first, second;     ///< the one that comes first in the caller's order, and the other
  Triple flux = {0.0, 0.0, 0.0};  ///< relative to the first; see CellBoundary
  double weight = 0.0;            ///< of the flux: the integral of phi / |x_j - x_i|_t
  double length = 0.0;
  double squared_path = std::numeric_limits<double>::infinity();  ///< of one half
};

/// A chunk of faces before it is integrated: where cells pass from one to the next.
struct ChunkFaces {
  EdgeCuts cuts;
  std::vector<OrderedFace> whole, cut;  ///< faces that lie in one cell, and the others
  std::vector<std::int32_t> doubts;     ///< sites with a piece at an edge without a vertex nearby
};

/// The contributions of a chunk of faces.
struct ChunkParts {
  std::vector<CellPart> cells;
  std::vector<BoundaryPart> boundaries;
  std::vector<OrderedFace> islands;  ///< faces with a piece inside, of a site of another face
  void clear();
};

/// The faces that are divided among given sites: for face f those in [first[f], first[f + 1]).
struct DividedFaces {
  std::span<const std::size_t> first;  ///< empty if there are none
  std::span<const std::int32_t> owners;
  [[nodiscard]] std::span<const std::int32_t> of(OrderedFace face) const {
    if (first.empty()) return {};
    const std::size_t f = as_index(face);
    return owners.subspan(first[f], first[f + 1] - first[f]);
  }
};

/// What most faces need, side by side: moments relative to the centroid, of which the first is 0
/// where the density is uniform.
struct FaceMoments {
  double area, second;
  Triple centroid;
};

/// What a chunk is computed from.
struct LabeledMesh {
  const Surface& surface;
  const OrderedSites& sites;
  const NearLists& lists;
  const FaceEdges& edges;
  std::span<const Vec3> vertices;  // of `edges`
  std::span<const VertexLabel> labels;
  std::span<const FaceMoments> moments;  // per face
  std::span<const Vec3> normals;         // per face
  std::span<const double> flat;  // per face, its density; -1 where it varies. Empty if uniform
  DividedFaces divided;
  double squared_spacing;
};

/// Call visit(site) once for each cell that the edges of a face meet between its corners, but that
/// holds none of these.
template <typename Visit>
void for_each_between(const LabeledMesh& mesh, const EdgeCuts& cuts, OrderedFace face,
                      const Visit& visit) {
  const auto [a, b, c] = mesh.edges.corners()[as_index(face)];
  const std::int32_t i = mesh.labels[as_index(a)].site, j = mesh.labels[as_index(b)].site;
  const std::int32_t k = mesh.labels[as_index(c)].site;
  const FaceEdges::OfFace& edges = mesh.edges.of(face);
  std::array<std::span<const EdgeCuts::Link>, 3> links;
  for (std::size_t e = 0; e < 3; ++e) links[e] = cuts.of(edges.edges[e]);
  for (std::size_t edge = 0; edge < 3; ++edge)
    for (std::size_t n = 0; n + 1 < links[edge].size(); ++n) {
      const std::int32_t site = links[edge][n].beyond;
      bool known = site == i || site == j || site == k;
      for (std::size_t e = 0; e <= edge && !known; ++e)
        for (std::size_t m = 0; m + 1 < links[e].size() && (e < edge || m < n) && !known; ++m)
          known = links[e][m].beyond == site;
      if (!known) visit(site);
    }
}

/// Call visit(site) once for each cell that the border of a face meets.
template <typename Visit>
void for_each_on_border(const LabeledMesh& mesh, const EdgeCuts& cuts, OrderedFace face,
                        const Visit& visit) {
  const auto [a, b, c] = mesh.edges.corners()[as_index(face)];
  const std::int32_t i = mesh.labels[as_index(a)].site, j = mesh.labels[as_index(b)].site;
  const std::int32_t k = mesh.labels[as_index(c)].site;
  if (i < 0 || j < 0 || k < 0 || !(mesh.moments[as_index(face)].area > 0.0)) return;
  visit(i);
  if (j != i) visit(j);
  if (k != i && k != j) visit(k);
  if (i != j || j != k) for_each_between(mesh, cuts, face, visit);
}

/// Integrates cells over chunks of faces, one face after another; one object per thread. Most faces
/// lie in one cell or in two, which takes no clipping.
class ChunkCells {
 public:
  /// The argument must outlive this.
  explicit ChunkCells(const LabeledMesh& mesh);

  void integrate(const ChunkFaces& faces, ChunkParts& parts);

  /// The faces of the last chunk that neither lie in one cell nor have just one chord.
  [[nodiscard]] std::span<const OrderedFace> rest() const { return rest_; }

 private:
  static constexpr std::size_t kStaged = 64;
  using Numbers = std::array<double, kStaged>;
  /// Faces with one chord, side by side: corner c belongs to j, the rest to i.
  struct alignas(64) Chords {
    Numbers cx, cy, cz, ux, uy, uz, vx, vy, vz, dx, dy, dz, nx, ny, nz;
    Numbers area, ix, iy, iz, i2, jx, jy, jz, j2;
    Numbers flux_x, flux_y, flux_z, weight, length, path;
    Numbers density;
    std::array<OrderedFace, kStaged> face;
    std::array<std::int32_t, kStaged> i, j;
  };
  /// Pieces of boundaries, side by side.
  struct alignas(64) Segments {
    Numbers rx, ry, rz, ax, ay, az, dx, dy, dz, nx, ny, nz, fp, fq;
    Numbers flux_x, flux_y, flux_z, weight, length, path;
    std::array<std::int32_t, kStaged> i, j;
  };
  /// A density that is linear on a face, known at one of its corners.
  struct FaceDensity {
    Triple gradient, corner;
    double at_corner;
    [[nodiscard]] double at(const Triple& x) const { return at_corner + gradient.dot(x - corner); }
  };

  void begin(const ChunkFaces& faces, ChunkParts& parts);
  void add_wholes();
  void add_whole(OrderedFace face, std::int32_t site);
  void add_flat(CellPart& part, OrderedFace face, double density, const Triple& x) const;
  void stage_chords();
  [[nodiscard]] bool stage_chord(OrderedFace face);
  void cut_chords();
  void cut_linear_chord(OrderedFace face, std::size_t odd, std::int32_t i, std::int32_t j,
                        const Triple& after, const Triple& before);
  void integrate_chords(std::size_t count);
  [[nodiscard]] bool divide_in_three(OrderedFace face);
  void divide(OrderedFace face);
  [[nodiscard]] bool divide_by_arcs(OrderedFace face);
  [[nodiscard]] bool meeting_point(OrderedFace face, std::int32_t i, std::int32_t j, std::int32_t k,
                                   Triple& x) const;
  void clip(OrderedFace face);
  void divide_among(OrderedFace face, std::span<const std::int32_t> owners);
  [[nodiscard]] bool add_clipped(OrderedFace face, std::int32_t site);
  void start_polygon(OrderedFace face, std::int32_t site);
  void cut_by_rivals(std::int32_t site);
  void cut_by(std::int32_t site, std::int32_t other);

  /// The density of a face; -1 if it varies there.
  [[nodiscard]] double flat_density(OrderedFace face) const {
    return uniform_ ? 1.0 : mesh_->flat[as_index(face)];
  }
  [[nodiscard]] FaceDensity linear_density(OrderedFace face, std::size_t corner) const;
  void add_polygon(OrderedFace face, std::int32_t site, std::span<const Triple> points);
  void add_flat_polygon(OrderedFace face, double density, std::int32_t site,
                        std::span<const Triple> points);
  void add_linear_polygon(OrderedFace face, std::int32_t site, std::span<const Triple> points);
  void add_segment(OrderedFace face, std::int32_t i, std::int32_t j, const Triple& p,
                   const Triple& q);
  void add_segment(OrderedFace face, std::int32_t i, std::int32_t j, const Triple& p,
                   const Triple& q, double density_at_p, double density_at_q);
  void flush_segments();
  void add_boundary(std::int32_t i, std::int32_t j, const Triple& flux, double weight,
                    double length, double squared_path);
  [[nodiscard]] CellPart& cell(std::int32_t site) {
    Slot& slot = slots_[as_index(site)];
    if (slot.stamp != stamp_) {
      slot = {stamp_, static_cast<std::uint32_t>(parts_->cells.size())};
      parts_->cells.push_back({site});
    }
    return parts_->cells[slot.place];
  }
  [[nodiscard]] BoundaryPart& boundary(std::int32_t first, std::int32_t second);
  void make_room_for_boundaries();
  [[nodiscard]] std::int32_t label(std::int32_t vertex) const {
    return mesh_->labels[as_index(vertex)].site;
  }
  [[nodiscard]] Triple position(std::int32_t site) const { return mesh_->lists.position(site); }

  /// Where the parts of a site or of a pair of sites are, if `stamp` is that of the chunk.
  struct Slot {
    std::uint32_t stamp = 0, place = 0;
  };
  struct PairSlot {
    std::uint32_t stamp = 0, place = 0;
    std::int32_t first = 0, second = 0;
  };
  [[nodiscard]] PairSlot& slot_of(std::int32_t first, std::int32_t second);

  const LabeledMesh* mesh_;
  bool uniform_;
  ChunkParts* parts_ = nullptr;
  const std::int32_t* originals_ = nullptr;  // per site
  std::uint32_t stamp_ = 0;
  std::vector<Slot> slots_;      // per site
  std::vector<PairSlot> pairs_;  // a hash table
  std::size_t last_pair_ = 0;    // its place among the boundaries
  const ChunkFaces* faces_ = nullptr;
  FaceArcs arcs_;
  std::vector<OrderedFace> rest_;  // faces that are not staged
  Chords chords_;
  std::size_t chord_count_ = 0;
  Segments segments_;
  std::size_t segment_count_ = 0;
  // Of a face that is clipped:
  struct Corner {
    Triple x;             // relative to the site
    std::int32_t beyond;  // a site, or -1 - k on edge k of the face
  };
  std::vector<Corner> polygon_, kept_;
  double squared_radius_ = 0.0;  // of the polygon
  std::int32_t taken_by_ = -1;   // a site that it belongs to as a whole
  std::vector<double> sides_;
  std::vector<std::int32_t> owners_;
  std::vector<Rival> rivals_;
  std::vector<Triple> points_;
};

}  // namespace dapple
