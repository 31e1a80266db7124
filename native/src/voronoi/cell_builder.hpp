// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <optional>

#include "base/laps.hpp"
#include "base/progress.hpp"
#include "voronoi/cell_integrals.hpp"
#include "voronoi/face_march.hpp"
#include "voronoi/shared_faces.hpp"

namespace dapple {

/// Computes the cells of one set of sites after another on a surface, and keeps its memory: with as
/// many sites as before, hardly anything is allocated again.
class CellBuilder {
 public:
  /// \param surface must outlive the builder
  explicit CellBuilder(const Surface& surface);
  CellBuilder(const CellBuilder&) = delete;
  CellBuilder& operator=(const CellBuilder&) = delete;

  /// \param graph   of the caller's sites, or null; must outlive calls of polygons()
  /// \param leaves_gaps whether, where cells follow the surface, faces without density that are far
  ///                from all sites may belong to none, and parts without any site do
  /// \param result  receives the diagram, in its own memory
  void build(const Sites& sites, const SiteGraph* graph, Cells cells, bool leaves_gaps,
             Context* context, RestrictedVoronoi& result);

  /// The same, by a flood from each site alone, after which polygons() gives their pieces.
  void build_by_floods(const Sites& sites, const SiteGraph* graph, Cells cells, bool leaves_gaps,
                       Context* context, RestrictedVoronoi& result);

  /// Forget the lists of near sites, as for other sites.
  void forget() {
    if (march_) march_->lists().forget();
  }

  /// The polygons of the cells built last, by floods.
  [[nodiscard]] std::vector<CellPolygon> polygons(Context* context);

 private:
  /// The working memory of one thread.
  struct Worker {
    explicit Worker(const CellBuilder& builder)
        : flood(builder.surface_, builder.sites_, builder.index_, &builder.links_),
          integrals(builder.surface_, flood) {
      flood.restart(builder.support());
    }
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    CellFlood flood;
    CellIntegrals integrals;
    std::vector<CellBoundary> boundary;  // of one cell
    std::vector<OrderedFace> seeds;      // of its flood
  };

  /// The output of a chunk of cells until its place in the result is known.
  struct Chunk {
    std::span<const std::int32_t> sites;
    std::vector<CellBoundary> boundaries;
    std::vector<Coverage> pieces;
    std::size_t first_boundary = 0, first_piece = 0;

    void clear() {
      sites = {};
      boundaries.clear();
      pieces.clear();
      first_boundary = first_piece = 0;  // those of another result may lie beyond the next one
    }
  };

  void begin(std::size_t count, Cells cells, bool leaves_gaps, Context* context,
             RestrictedVoronoi& result);
  void find_support(std::size_t count);
  [[nodiscard]] const DensitySupport* support() const { return leaves_ ? support_.get() : nullptr; }
  [[nodiscard]] bool is_for_march(const Sites& sites) const;
  void march(const Sites& sites, Context* context);
  void flood(const Sites& sites, const SiteGraph* graph);
  void share_out_alone();
  void place_sites(const Sites& sites);
  [[nodiscard]] std::vector<OrderedFace> faces_without_sites() const;
  void share_out_on(std::span<const OrderedFace> faces, Context* context);
  void find_area_to_cover();
  void start(const Sites& sites, const SiteGraph* graph);
  [[nodiscard]] std::size_t count() const { return sites_.size(); }
  [[nodiscard]] std::span<const Share> shares_of(std::int32_t site) const;
  template <typename Visit, typename Flush>
  void for_each_piece(Worker& worker, std::int32_t site, const Visit& visit, const Flush& flush);
  [[nodiscard]] std::span<const OrderedFace> seeds_of(Worker& worker, std::int32_t site) const;
  [[nodiscard]] bool is_divided(OrderedFace face) const;
  [[nodiscard]] std::span<const std::int32_t> owners_of(OrderedFace face) const;

  void integrate(std::span<const std::int32_t> sites, Context* context);
  void place(std::span<Chunk> chunks);
  void integrate(Chunk& chunk, Worker& worker);
  void put_away(Chunk& chunk);
  [[nodiscard]] std::size_t original(std::int32_t site) const {
    return static_cast<std::size_t>(sites_.original(site));
  }
  RestrictedVoronoi::Row& row(std::int32_t site) { return result_->rows[original(site)]; }

  [[nodiscard]] bool missing_area() const;
  [[nodiscard]] bool owns_nothing() const;
  void share_uncovered_faces(Context* context);
  [[nodiscard]] std::vector<std::int32_t> winners(OrderedFace face,
                                                  std::span<const std::int32_t> asked,
                                                  std::span<const std::int32_t> rivals);
  [[nodiscard]] std::vector<OrderedFace> without_owner(std::vector<OrderedFace> faces) const;
  void add_nearest_owners(std::span<const OrderedFace> faces);
  [[nodiscard]] std::vector<Share> nearest_owners(OrderedFace face);
  [[nodiscard]] bool reset_far(CellFlood& flood, std::int32_t site) const;
  [[nodiscard]] std::int32_t nearest_to(OrderedFace face) const;
  void index_owners();
  void collect(std::int32_t site, std::vector<CellPolygon>& out);

  const Surface& surface_;
  OrderedSites sites_;
  SiteIndex index_;
  OrderedLinks links_;
  bool whole_ = false;      // no cell can have parts that are not connected to its site
  bool connected_ = false;  // cells follow the surface
  bool leaves_ = false;     // faces far from density and parts without any site belong to no cell
  std::optional<bool> has_gaps_;
  std::shared_ptr<const DensitySupport> support_;  // for the last number of sites, if it has gaps
  std::size_t support_count_ = 0;
  std::vector<double> component_areas_;  // only where there are several
  double area_to_cover_ = 0.0;
  Context* context_ = nullptr;
  std::unique_ptr<FaceMarch> march_;  // made when first needed
  tbb::enumerable_thread_specific<Worker> workers_;
  std::vector<std::int32_t> all_;  // sites
  std::vector<Chunk> chunks_;      // in work
  std::size_t boundary_count_ = 0, piece_count_ = 0;
  std::vector<Coverage> pieces_;      // of the last floods; the first piece_count_ count
  std::vector<Share> shares_;         // of uncovered faces; sorted by site
  std::vector<std::size_t> divided_;  // per face, one more: rows of owners_
  std::vector<std::int32_t> owners_;  // of divided faces
  RestrictedVoronoi* result_ = nullptr;
};

}  // namespace dapple
