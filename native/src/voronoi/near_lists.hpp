// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <limits>

#include "voronoi/near_sites.hpp"
#include "voronoi/site_index.hpp"

namespace dapple {

/// Answers which site is nearest to a point, from lists of the sites around each site, which are
/// kept while the sites move little. Where a list could lack a site that matters, the index is
/// searched: answers do not depend on how old a list is. Distances are compared as they are
/// rounded, and at equal ones the first site in the caller's order counts.
class NearLists {
 public:
  /// The arguments must outlive the lists.
  NearLists(const Surface& surface, const OrderedSites& sites, const SiteIndex& index);

  /// Whether the lists hold for other sites, so that these need not be sorted and searched again.
  [[nodiscard]] bool hold_for(const Sites& sites, bool by_component);

  /// After the sites have moved, if hold_for() them.
  void move();

  /// Whether the sites have the order of the last time.
  [[nodiscard]] bool were_moved() const { return were_moved_; }

  void forget() { made_ = false; }

  /// After the sites and the index have changed.
  /// \param by_component whether a site competes with those of its component alone
  void make(bool by_component);

  /// Of the sites at one place the first, which owns their cell.
  [[nodiscard]] std::int32_t leader(std::int32_t site) const { return leaders_[as_index(site)]; }
  [[nodiscard]] bool compete(std::int32_t site, std::int32_t other) const {
    return components_.empty() || components_[as_index(site)] == components_[as_index(other)];
  }
  /// A site of a component; -1 if it has none. Of all, if components do not count.
  [[nodiscard]] std::int32_t site_on(std::int32_t component) const {
    return components_.empty() ? 0 : site_on_[as_index(component)];
  }

  [[nodiscard]] Triple position(std::int32_t site) const { return Triple(sites_->position(site)); }
  /// The positions of all sites.
  [[nodiscard]] const Vec3* positions() const { return sites_->positions.data(); }
  /// The squared distance of a site from a point.
  [[nodiscard]] double squared_distance(std::int32_t site, const Triple& point) const {
    return (point - Triple(sites_->position(site))).squared_norm();
  }

  struct Nearest {
    std::int32_t site;
    double squared_distance;
  };
  /// The nearest to a point of those that compete with `from`, which should be near it.
  [[nodiscard]] Nearest nearest(const Triple& point, std::int32_t from) const;

  /// The same by a search alone, for a point that may be far from the site.
  [[nodiscard]] Nearest search(const Triple& point, std::int32_t from) const;

  /// Of the sites that compete with i, other than j and k, the one nearest to a point, if it is
  /// nearer than `squared` by more than rounding; otherwise -1.
  [[nodiscard]] std::int32_t nearer(const Triple& point, double squared, std::int32_t i,
                                    std::int32_t j, std::int32_t k = -1) const;

  /// The bisector by which a ray leaves the cell of a site.
  struct Exit {
    double t;
    std::int32_t site;  ///< beyond it; -1 if there is none before `last`
  };
  /// \param start, along  the ray start + t * along, in the cell from t = `first` on
  /// \param other         a site that does not count
  [[nodiscard]] Exit exit(std::int32_t site, const Triple& start, const Triple& along, double first,
                          double last, std::int32_t other) const;

  /// The squared distance within which near_rivals() has all sites that compete with a site.
  [[nodiscard]] double known_reach(std::int32_t site) const {
    return lists_[as_index(site)].complete;
  }
  /// These sites, the nearest first.
  void near_rivals(std::int32_t site, std::vector<Rival>& rivals) const;
  /// Those from there on whose squared distance is not above `limit`, the nearest first.
  void far_rivals(std::int32_t site, double limit, std::vector<Rival>& rivals) const;

 private:
  static constexpr std::size_t kBlock = 8, kBlocks = 2, kMost = kBlock * kBlocks;

  /// The sites nearest to one.
  struct alignas(64) List {
    std::array<Eight, kBlocks> places;  // what is missing is far away
    std::array<std::int32_t, kMost> sites;
    std::array<double, kBlocks> nearest;  // squared distance of the nearest of each block
    double complete;                      // squared distance within which none is missing
    std::size_t count;

    void put(std::size_t k, const Triple& place, std::int32_t site);
    [[nodiscard]] Triple place(std::size_t k) const {
      const Eight& block = places[k / kBlock];
      return {block[0][k % kBlock], block[1][k % kBlock], block[2][k % kBlock]};
    }
    void measure(const Triple& from);
  };

  void fill(List& list, std::int32_t site, NearSites<SiteIndex>& near);
  [[nodiscard]] double largest_move(const Sites& sites) const;
  [[nodiscard]] bool precedes(std::int32_t site, std::int32_t other) const {
    return sites_->original(site) < sites_->original(other);
  }
  void take_exits(const List& list, std::size_t block, const Triple& x, const Triple& r,
                  const Triple& along, std::int32_t other, Exit& exit) const;
  template <typename Visit>
  void search_around(const Triple& point, double squared, std::int32_t site,
                     const Visit& visit) const;

  const Surface* surface_;
  const OrderedSites* sites_;
  const SiteIndex* index_;
  std::vector<List> lists_;
  std::vector<double> complete_;  // as made, without the square
  std::vector<Vec3> made_at_;     // where the sites were then
  double moved_ = 0.0;            // farthest move since then
  std::vector<std::int32_t> leaders_;
  std::vector<std::int32_t> components_;  // per site; empty if all compete
  std::vector<std::int32_t> site_on_;     // per component
  bool made_ = false, alone_ = false;     // whether there are lists; no two sites at one place
  bool were_moved_ = false;
  tbb::enumerable_thread_specific<NearSites<SiteIndex>> searches_;
};

template <typename Visit>
void NearLists::search_around(const Triple& point, double squared, std::int32_t site,
                              const Visit& visit) const {
  const Vec3 place(point.x, point.y, point.z);
  // The index measures distances in another order of sums.
  index_->for_each_near({place, place},
                        squared * (1.0 + 1e-12) + std::numeric_limits<double>::min(),
                        [&](std::int32_t other) {
                          if (compete(site, other)) visit(leaders_[as_index(other)]);
                        });
}

}  // namespace dapple
