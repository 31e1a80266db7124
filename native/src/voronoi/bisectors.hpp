// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/cell_polyhedron.hpp"
#include "voronoi/site_index.hpp"

namespace dapple {

/// The half-space of points nearer to the site than to a neighbor: x . normal <= offset, x
/// relative to the site.
struct Bisector {
  Vec3 normal;  ///< x_j - x_i
  double offset;
  double squared_distance;
  std::int32_t site;  ///< j, ordered
  bool idle = false;  ///< whether it is known to cut nothing off any face
};

/// The bisectors of one site in order of distance, fetched as far as someone asks.
class Bisectors {
 public:
  /// The arguments must outlive the bisectors.
  Bisectors(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
      : surface_(&surface), sites_(&sites), index_(&index) {}

  /// Turn to a site, with all others.
  void reset(std::int32_t site);

  /// Turn to a site, with `others` alone, whether it is one of them or not.
  void reset_among(std::int32_t site, std::span<const std::int32_t> others);

  /// The site that owns the cell: of those at the same place the one of the lowest (caller's) index
  /// that is known so far. It may have a lower one itself, but nothing is fetched to tell.
  [[nodiscard]] std::int32_t owner();

  /// Bisector k, or null if there are no more.
  [[nodiscard]] const Bisector* at(std::size_t k) {
    while (k >= settled_ && next_rival_ < rivals_.size()) take_rivals();
    while (k >= settled_ && fetched_ < index_->population()) fetch_more();
    return k < settled_ ? bisectors_.data() + k : nullptr;
  }

 private:
  /// One of a given set of sites, before its bisector is asked for.
  struct Rival {
    double squared_distance;
    std::int32_t original;  // the caller's index: the order at equal distances
    std::int32_t site;
    bool operator<(const Rival& other) const {
      return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                        : original < other.original;
    }
  };

  void fetch_more();
  void fetch(std::size_t count);
  [[nodiscard]] bool take_all_that_cut();
  [[nodiscard]] bool shrink_to_cell(std::vector<std::int32_t>& found);
  [[nodiscard]] std::int32_t first_at_place_of(std::int32_t site);
  void take_rivals();
  void take_links();
  [[nodiscard]] Bisector bisector_to(std::int32_t other) const;
  void add(std::int32_t other) { bisectors_.push_back(bisector_to(other)); }
  void sort();
  void drop_twins();
  void settle();

  const Surface* surface_;
  const OrderedSites* sites_;
  const SiteIndex* index_;
  Eigen::AlignedBox3d box_;  // around the surface, once it is needed
  CellPolyhedron cell_;
  std::int32_t site_ = 0;
  std::size_t fetched_ = 0;
  std::size_t settled_ = 0;
  std::vector<Neighbor> found_;
  std::vector<Rival> rivals_;  // the nearest first, as far as they were taken
  std::size_t next_rival_ = 0;
  std::vector<Bisector> bisectors_;
};

}  // namespace dapple
