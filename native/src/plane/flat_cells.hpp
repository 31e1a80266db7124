// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "plane/flat_polygon.hpp"
#include "plane/flat_sites.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// Finds whose cells touch the cell of one site after another; one per thread. A cell is cut by the
/// sites around it in order of distance, until the next one is farther than twice the farthest
/// corner. What one site needed the next one will: only how long a search takes depends on that.
class FlatCells {
 public:
  /// In the plane, as far as a frame that holds all sites.
  /// \param sites must outlive this
  FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame);
  /// On the torus.
  /// \param sites must outlive this
  explicit FlatCells(const FlatSites& sites);

  /// Turn to a site, by its place.
  void turn_to(std::size_t place);

  /// The sites whose cells touch this one's, in order of distance. Of sites at one place it is the
  /// first.
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
  std::vector<Rival> cutting_;  // what has cut the cell; edges are labeled by their numbers
  std::vector<SiteGraph::Link> links_;
  double squared_reach_ = 0.0;
  std::vector<Rival> found_;  // the first ones are near_
  std::span<Rival> near_;     // within reach, the nearest first
  std::size_t next_ = 0;      // in near_, that has not cut yet
  std::size_t neighborhood_;
  double squared_reach_around_;
  std::vector<Place> around_;  // all within reach of the neighborhood
  std::vector<Place> further_;
  double needed_ = 0.0;  // the largest squared distance that was needed there so far
};

}  // namespace dapple
