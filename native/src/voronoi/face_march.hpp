// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <dapple/restricted_voronoi.hpp>
#include <memory>

#include "voronoi/chunk_cells.hpp"
#include "voronoi/density_support.hpp"
#include "voronoi/shared_faces.hpp"

namespace dapple {

/// Computes cells face by face: labels each vertex with its nearest site, cuts the edges whose ends
/// have two labels, and integrates what each face contributes to the cells that it meets. This
/// takes less time than a flood from each site where there are more faces than sites. Cells are
/// those of the nearest site on the same component, or on all of the surface.
class FaceMarch {
 public:
  /// The arguments must outlive this.
  FaceMarch(const Surface& surface, const OrderedSites& sites, const SiteIndex& index);

  [[nodiscard]] NearLists& lists() { return lists_; }
  [[nodiscard]] const NearLists& lists() const { return lists_; }

  /// Find where cells pass from one to the next.
  /// \param support the faces that belong to cells, and hold all sites; null: all faces. Must
  ///                outlive this, or the next start()
  /// \param divided faces that are divided among given sites; must outlive this, or divide()
  void start(const DensitySupport* support, DividedFaces divided, Context* context);

  /// The faces with a piece that is not connected to its site; sorted.
  [[nodiscard]] std::span<const OrderedFace> disconnected_faces();

  /// The connected pieces on these faces and their neighbors.
  [[nodiscard]] std::vector<Coverage> pieces_around(std::span<const OrderedFace> faces);

  /// Integrate cells, after more faces have been divided, or none.
  void divide(std::span<const OrderedFace> faces, DividedFaces divided, Context* context);

  /// The faces that are not divided, but have a piece inside that is not connected to its site.
  [[nodiscard]] std::vector<OrderedFace> islands() const;

  /// Add up the contributions.
  void collect(RestrictedVoronoi& result);

 private:
  /// Memory for following one cell over the surface.
  struct Follower {
    std::vector<std::int32_t> stamps;  // per face
    std::int32_t stamp = 0;
    std::vector<OrderedFace> faces;
    std::vector<std::int32_t> later;  // half-edges
  };
  /// A contribution to a boundary, by the cell on one side.
  struct Side {
    std::uint32_t chunk, part;
  };

  void gather_faces();
  void gather_flat_densities();
  void find_sites_of_parts();
  [[nodiscard]] std::int32_t site_around(std::int32_t vertex) const;
  [[nodiscard]] bool has(OrderedFace face) const { return !support_ || support_->has(face); }
  void label(std::size_t begin, std::size_t end);
  [[nodiscard]] std::int32_t first_guess(std::int32_t vertex, std::int32_t some) const;
  void sort_faces(std::size_t chunk);
  void find_doubts(ChunkFaces& faces, std::span<const OrderedFace> among) const;
  [[nodiscard]] bool has_vertex_beyond(OrderedFace face, std::size_t edge, std::int32_t site) const;

  void find_doubtful_sites();
  void find_roots();
  void count_pieces();
  void count_pieces_by_labels();
  [[nodiscard]] bool follow_doubtful_sites();
  [[nodiscard]] bool follow(Follower& follower, std::int32_t site) const;
  [[nodiscard]] bool passes(std::int32_t half_edge, std::int32_t site) const;
  void find_disconnected(std::size_t chunk, std::vector<OrderedFace>& faces) const;
  void find_homes();
  [[nodiscard]] std::span<const EdgeCuts::Link> cuts(OrderedFace face, std::size_t edge) const {
    return faces_[as_index(face) / FaceEdges::kFaces].cuts.of(edges_->of(face).edges[edge]);
  }
  /// Call visit(site) once for each cell that the border of a face meets.
  template <typename Visit>
  void for_each_site_on(OrderedFace face, const Visit& visit) const;
  [[nodiscard]] bool is_connected(std::int32_t site, OrderedFace face) const;
  [[nodiscard]] bool has_area(OrderedFace face) const {
    return moments_[as_index(face)].area > 0.0;
  }

  void sum_cells();
  void sort_sides();
  [[nodiscard]] std::size_t count_row(std::int32_t site) const;
  [[nodiscard]] std::size_t merge_row(std::int32_t site, CellBoundary* out) const;

  const Surface* surface_;
  const OrderedSites* sites_;
  const DensitySupport* support_ = nullptr;
  std::vector<std::int32_t> site_on_part_;  // of the support; -1: none
  NearLists lists_;
  std::shared_ptr<const FaceEdges> edges_;
  std::vector<FaceMoments> moments_;  // see LabeledMesh
  std::vector<double> flat_;
  std::vector<Vec3> normals_;
  std::vector<Vec3> vertices_;  // with copies, if there are any
  std::vector<VertexLabel> labels_;
  LabeledMesh mesh_;
  std::vector<ChunkFaces> faces_;  // per chunk
  std::vector<ChunkParts> parts_;  // per chunk
  // Whether faces are integrated when it is known which are divided, instead of at once while their
  // cuts are in the cache: where the last cells were often not connected. This affects only time.
  bool waits_ = false;
  std::vector<char> stale_;  // per chunk: whether it must be integrated
  tbb::enumerable_thread_specific<EdgeCutter> cutters_;
  tbb::enumerable_thread_specific<ChunkCells> workers_;

  // Whether cells are connected:
  std::vector<std::atomic<char>> descends_;  // per vertex, see EdgeCutter::find()
  std::vector<std::atomic<char>> doubtful_;  // per site
  std::vector<std::atomic<std::uint64_t>>
      pieces_;                        // per doubtful site: the sum of mark_of() over its faces
  std::vector<std::int32_t> doubts_;  // these sites
  std::vector<std::vector<OrderedFace>> reached_;  // per doubt that is lost: the connected part
  std::vector<std::int32_t> lost_;                 // per site: its place there, or -1
  std::vector<std::vector<OrderedFace>> found_;    // per chunk
  std::vector<OrderedFace> disconnected_;
  std::vector<std::pair<OrderedFace, std::int32_t>> homes_;  // the sites by face, if any are lost
  tbb::enumerable_thread_specific<Follower> followers_;

  // Sums:
  std::vector<CellPart> cells_;                      // per site
  std::vector<std::size_t> first_side_, next_side_;  // per site
  std::vector<Side> sides_;
  std::vector<std::size_t> first_boundary_;  // per site
};

}  // namespace dapple
