// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "site_index.hpp"

namespace dapple {

/// The half-space of points nearer to the site than to a neighbour: x . normal <= offset, x
/// relative to the site.
struct Bisector {
  Vec3 normal;  ///< x_j - x_i
  double offset;
  double squared_distance;
  std::int32_t site;  ///< j, ordered
};

/// The bisectors of one site in order of distance, fetched as far as someone asks.
class Bisectors {
 public:
  /// The arguments must outlive the bisectors.
  Bisectors(const OrderedSites& sites, const SiteIndex& index) : sites_(&sites), index_(&index) {}

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
    while (k >= settled_ && fetched_ < index_->population()) fetch(2 * fetched_);
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

  void fetch(std::size_t count);
  void take_rivals();
  void take_links();
  void add(std::int32_t other);
  void sort();
  void drop_twins();
  void settle();

  const OrderedSites* sites_;
  const SiteIndex* index_;
  std::int32_t site_ = 0;
  std::size_t fetched_ = 0;
  std::size_t settled_ = 0;
  std::vector<Neighbour> found_;
  std::vector<Rival> rivals_;  // the nearest first, as far as they were taken
  std::size_t next_rival_ = 0;
  std::vector<Bisector> bisectors_;
};

}  // namespace dapple
