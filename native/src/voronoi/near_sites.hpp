// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "voronoi/site_index.hpp"

namespace dapple {

/// Another site.
struct Rival {
  double squared_distance;
  std::int32_t original;  ///< the caller's index: the order at equal distances
  std::int32_t site;
  bool operator<(const Rival& other) const {
    return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                      : original < other.original;
  }
};

/// The sites within reach of one after another. Sites of one neighborhood have much the same others
/// around them, so that these are searched for once; and what one neighborhood needed the next one
/// will: only how long a search takes depends on that.
class NearSites {
 public:
  /// The arguments must outlive this.
  NearSites(const Surface& surface, const OrderedSites& sites, const SiteIndex& index);

  /// After the sites have changed.
  void restart();

  /// Turn to a site.
  void turn_to(std::int32_t site);

  /// All within reach of it but itself, the nearest first.
  [[nodiscard]] const std::vector<Rival>& all() const { return near_; }

  /// Whether these are all that there are.
  [[nodiscard]] bool is_complete() const;

  /// Reach further for this site.
  void extend();

  /// Note that a squared distance is as far as this site had to look.
  void note_need(double squared_distance) { needed_ = std::max(needed_, squared_distance); }

 private:
  struct Place {
    Vec3 position;
    std::int32_t site;
  };

  void look_around(const SiteIndex::Neighborhood& here);
  void find(const Box& query, std::vector<Place>& found) const;
  void choose(const std::vector<Place>& places);

  const Surface* surface_;
  const OrderedSites* sites_;
  const SiteIndex* index_;
  std::int32_t site_ = 0;
  double squared_reach_ = 0.0;
  std::vector<Rival> near_;
  std::vector<Place> further_;
  std::size_t neighborhood_ = 0;
  std::vector<Place> around_;  // all within reach of the neighborhood
  double squared_reach_around_ = 0.0;
  double needed_ = 0.0;  // the largest squared distance that was needed there so far
};

}  // namespace dapple
