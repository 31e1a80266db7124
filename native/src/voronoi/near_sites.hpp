// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>

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

/// Finds the sites near each of a sequence of sites. Sites of one neighborhood share a search,
/// whose reach follows the need of the last neighborhood; this affects only the time of a search.
class NearSites {
 public:
  /// The arguments must outlive this.
  NearSites(const Surface& surface, const OrderedSites& sites, const SiteIndex& index);

  /// Call after the sites have changed.
  void restart();

  /// Start a site.
  void turn_to(std::int32_t site);

  static constexpr std::size_t kMost = 51;  ///< largest number returned

  /// All other sites within reach, the nearest first; at most kMost.
  [[nodiscard]] std::span<const Rival> all() const { return std::span(near_).first(count_); }

  /// How many there are.
  [[nodiscard]] std::size_t within_reach() const { return within_reach_; }

  /// The squared distance within which all() has every site, unless there are more than kMost.
  [[nodiscard]] double squared_reach() const { return squared_reach_; }

  /// Whether there are no others.
  [[nodiscard]] bool is_complete() const;

  /// Reach further for this site.
  void extend();

  /// Record the squared distance that this site needed.
  void note_need(double squared_distance) { need_ = std::max(need_, squared_distance); }

 private:
  /// Sites by coordinate, so that several are measured at once.
  struct Places {
    std::vector<std::int32_t> sites;
    std::vector<double> x, y, z;

    void clear();
    void add(std::int32_t site, const Vec3& position);
  };

  void look_around(const SiteIndex::Neighborhood& here);
  void put_need_away();
  [[nodiscard]] double most_needed();
  void look_at(const SiteIndex::Neighborhood& block);
  void measure(const Places& places);
  void choose(const Places& places);
  void sort();
  [[nodiscard]] bool sort_few();

  const Surface* surface_;
  const OrderedSites* sites_;
  const SiteIndex* index_;
  std::int32_t site_ = 0;
  double squared_reach_ = 0.0;
  std::vector<double> squared_;  // distances of places
  std::vector<Rival> near_;      // the first count_ are within reach
  std::size_t count_ = 0;
  std::size_t within_reach_ = 0;  // how many sites are, of which the first count_ are kept
  int extensions_ = 0;            // for this site
  Places further_;
  std::size_t neighborhood_ = 0;
  Places around_;  // all within reach of the neighborhood
  double squared_reach_around_ = 0.0;
  std::size_t block_ = 0;
  std::vector<std::size_t> groups_;  // that reach into what is around the block
  double squared_reach_block_ = 0.0;
  double need_ = 0.0;  // the largest squared distance that this site needed so far
  std::array<double, SiteBoxes::kFan>
      needs_{};                  // of the neighborhood's sites: the first need_count_
  std::vector<double> nearest_;  // squared distances, while looking far
  std::size_t need_count_ = 0;
};

}  // namespace dapple
