// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "plane/flat_polygon.hpp"
#include "plane/flat_sites.hpp"
#include "voronoi/near_sites.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// Finds the neighbors of one site after another; one object per thread. A cell is clipped by the
/// sites around it in order of distance, until the next one is farther than twice the farthest
/// corner.
class FlatCells {
 public:
  /// In the plane, within a frame that contains all sites.
  /// \param sites must outlive this
  FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame);
  /// On the torus.
  /// \param sites must outlive this
  explicit FlatCells(const FlatSites& sites);

  /// Start a site, given by its place.
  void turn_to(std::int32_t place);

  /// The sites whose cells touch this one's, in order of distance; of coincident sites the first.
  [[nodiscard]] std::span<const SiteGraph::Link> links() const { return links_; }
  /// Whether the cell ends at the frame.
  [[nodiscard]] bool at_frame() const;

 private:
  FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame, double area);
  void begin();
  [[nodiscard]] bool cut_by_near();
  void cut_by_nearest_to_corners();
  [[nodiscard]] std::int32_t nearest_to(const Vec2& corner) const;
  bool cut(std::int32_t image);
  [[nodiscard]] SiteGraph::Link link_to(std::int32_t image) const;
  void collect_links();

  const FlatSites* sites_;
  Eigen::AlignedBox2d frame_;
  NearSites<FlatSites> near_;
  std::int32_t place_ = 0;
  FlatPolygon cell_;
  // The sites that clipped the cell; edges are labeled by their indices.
  std::vector<SiteGraph::Link> cutting_;
  std::vector<SiteGraph::Link> links_;
};

}  // namespace dapple
