// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "plane/flat_polygon.hpp"
#include "plane/flat_sites.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// Finds the neighbors of one site after another; one object per thread. A cell is clipped by the
/// sites around it in order of distance, until the next one is farther than twice the farthest
/// corner. The reach of a search starts from that of the site before, which affects only the time.
class FlatCells {
 public:
  /// In the plane, within a frame that contains all sites.
  /// \param sites must outlive this
  FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame);
  /// On the torus.
  /// \param sites must outlive this
  explicit FlatCells(const FlatSites& sites);

  /// Start a site, given by its place.
  void turn_to(std::size_t place);

  /// The sites whose cells touch this one's, in order of distance; of coincident sites the first.
  [[nodiscard]] std::span<const SiteGraph::Link> links() const { return links_; }
  /// Whether the cell ends at the frame.
  [[nodiscard]] bool at_frame() const;

 private:
  struct Rival {
    double squared_distance;
    std::int32_t site;
    Vec2 offset;
    bool operator<(const Rival& other) const;
  };
  struct Place {
    Vec2 position;
    std::int32_t site;
  };

  FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame, double area);
  void begin();
  void look_around();
  void find(const Box& query, std::vector<Place>& found) const;
  void choose(const std::vector<Place>& places);
  [[nodiscard]] bool cut_by_near();
  void cut_by_nearest_to_corners();
  [[nodiscard]] Rival nearest_to(const Vec2& corner) const;
  bool cut(const Rival& rival);
  void collect_links();

  const FlatSites* sites_;
  Eigen::AlignedBox2d frame_;
  std::size_t place_ = 0;
  FlatPolygon cell_;
  std::vector<Rival>
      cutting_;  // the sites that clipped the cell; edges are labeled by their indices
  std::vector<SiteGraph::Link> links_;
  double squared_reach_ = 0.0;
  std::vector<Rival> found_;  // the first ones are near_
  std::span<Rival> near_;     // within reach, the nearest first
  std::size_t next_ = 0;      // index in near_ of the next one to clip by
  std::size_t neighborhood_;
  double squared_reach_around_;
  std::vector<Place> around_;  // all within reach of the neighborhood
  std::vector<Place> further_;
  double needed_ = 0.0;  // the largest squared distance needed there so far
};

}  // namespace dapple
