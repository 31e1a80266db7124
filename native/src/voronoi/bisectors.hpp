// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "base/laps.hpp"
#include "voronoi/half_spaces.hpp"
#include "voronoi/near_sites.hpp"
#include "voronoi/ordered_links.hpp"

namespace dapple {

/// The half-space of points nearer to the site than to a neighbor: x . normal <= offset, x
/// relative to the site.
struct Bisector {
  Vec3 normal;  ///< x_j - x_i
  double offset;
  double squared_distance;
  std::int32_t site;  ///< j, an ordered site
  bool idle = false;  ///< whether it is known to clip no face
};

/// Which sites compete with a site.
enum class Rivals {
  kAll,
  kInSight  ///< all except those of other components that face the other way
};

/// The bisectors of one site: those with near sites in order of distance, found on demand, and for
/// faces that these do not decide, those with sites near the face.
class Bisectors {
 public:
  /// The arguments must outlive the bisectors.
  /// \param links the sites whose bisectors bound cells, where these are known
  Bisectors(const Surface& surface, const OrderedSites& sites, const SiteIndex& index,
            const OrderedLinks* links = nullptr);

  /// Call after the sites have changed.
  void restart() { near_.restart(surface_->spacing(sites_->size())); }

  /// Start a site.
  void reset(std::int32_t site, Rivals rivals = Rivals::kAll);

  /// Start a site for a face far from it: no bisector counts as near.
  void reset_far(std::int32_t site);

  /// Start a site that competes with `others` only, whether it is one of them or not.
  void reset_among(std::int32_t site, std::span<const std::int32_t> others);

  /// The site that owns the cell: of coincident sites the one of lowest (caller's) index.
  [[nodiscard]] std::int32_t owner() const { return owner_; }

  /// Near bisector k, or null if there are no more.
  [[nodiscard]] const Bisector* at(std::size_t k) {
    while (k >= settled_ && next_rival_ < rivals_.size()) take_rivals();
    while (k >= settled_ && !complete_ && !ended_) look_further();
    return k < settled_ ? bisectors_.data() + k : nullptr;
  }

  /// Whether at() already gives all bisectors.
  [[nodiscard]] bool complete() const { return complete_; }

  /// A known bisector, near or far.
  [[nodiscard]] const Bisector& known(std::size_t k) const { return bisectors_[k]; }

  /// The numbers of the known far bisectors.
  [[nodiscard]] std::size_t first_far() const { return settled_; }
  [[nodiscard]] std::size_t end() const { return bisectors_.size(); }

  /// The number of the bisector with the site nearest to a point (relative to the site) among those
  /// not in `others`, if it is at least as near as the site itself and not a near one; otherwise
  /// kNone.
  static constexpr std::size_t kNone = ~std::size_t{0};
  [[nodiscard]] std::size_t nearest_to(const Vec3& point, std::span<const std::int32_t> others);

  /// Record that the bisectors up to a squared distance decide the cell.
  void note_need(double squared_distance) {
    near_.note_need(std::min(squared_distance, most_needed_));
  }

  /// Time spent on neighbor searches.
  [[nodiscard]] Laps& laps() { return laps_; }

  /// Number of bisectors known in their final order so far.
  [[nodiscard]] std::size_t settled() const { return settled_; }
  /// Their half-spaces, by the same numbers.
  [[nodiscard]] const HalfSpaces& half_spaces() const { return half_spaces_; }

 private:
  void begin(std::int32_t site, Rivals rivals);
  [[nodiscard]] bool is_out_of_sight(std::int32_t other) const;
  void look_further();
  void take_near();
  [[nodiscard]] bool is_near(std::int32_t other) const;
  [[nodiscard]] std::size_t place_of(std::int32_t site);
  [[nodiscard]] std::int32_t first_at_place_of(std::int32_t site) const;
  void take_rivals();
  void take_links();
  [[nodiscard]] Rival rival(std::int32_t other) const;
  [[nodiscard]] Bisector bisector_to(std::int32_t other) const;
  void add(std::int32_t other) { bisectors_.push_back(bisector_to(other)); }
  void drop_twins();
  void settle(std::size_t count);

  const Surface* surface_;
  const OrderedSites* sites_;
  const SiteIndex* index_;
  const OrderedLinks* links_;
  std::int32_t site_ = 0;
  std::int32_t owner_ = 0;
  std::size_t settled_ = 0;
  bool complete_ = false;      // whether all are known
  bool ended_ = false;         // whether no more count as near
  bool all_ = true;            // whether all near ones compete
  std::vector<Rival> rivals_;  // the nearest first, as far as they were taken
  std::size_t next_rival_ = 0;
  std::vector<Bisector> bisectors_;
  HalfSpaces half_spaces_;  // of those that are settled
  NearSites<SiteIndex> near_;
  double most_needed_ = 0.0;  // beyond it bisectors are found in another way
  Laps laps_;
};

}  // namespace dapple
