// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/triple.hpp"
#include "voronoi/site_boxes.hpp"

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
/// \tparam Index has the places: SiteIndex on a surface, FlatSites in the plane and on the torus
template <class Index>
class NearSites {
 public:
  /// \param index   must outlive this
  /// \param spacing of the sites, about which the first search starts
  NearSites(const Index& index, double spacing) : index_(&index) { restart(spacing); }

  /// Call after the sites have changed.
  void restart(double spacing);

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

  void look_around(const SiteBoxes::Neighborhood& here);
  void put_need_away();
  [[nodiscard]] double most_needed();
  void look_at(const SiteBoxes::Neighborhood& block);
  [[nodiscard]] double squared_distance_of_nearest(std::size_t count, const Vec3& point);
  void measure(const Places& places);
  void choose(const Places& places);
  void sort();
  [[nodiscard]] bool sort_few();

  static constexpr double kFirstReach = 1.8;  // spacings
  static constexpr double kFurther = 2.25;    // factor of the squared reach
  static constexpr int kFewExtensions = 2;    // of one site, before it searches on its own
  static constexpr double kMargin = 1.25;  // of the squared reach that the last neighborhood needed
  static constexpr double kAlike = 4.0;    // largest representative need, relative to the median
  static constexpr std::size_t kNone = ~std::size_t{0};
  static constexpr std::size_t kFew = 24;

  const Index* index_;
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

template <class Index>
void NearSites<Index>::restart(double spacing) {
  const double reach = kFirstReach * spacing;
  squared_reach_around_ = reach * reach;
  neighborhood_ = block_ = kNone;
  need_ = 0.0;
  need_count_ = 0;
}

template <class Index>
void NearSites<Index>::turn_to(std::int32_t site) {
  put_need_away();
  site_ = site;
  extensions_ = 0;
  const SiteBoxes::Neighborhood here = index_->neighborhood(site);
  if (here.number != neighborhood_) look_around(here);
  squared_reach_ = squared_reach_around_;
  choose(around_);
}

template <class Index>
bool NearSites<Index>::is_complete() const {
  return within_reach_ + 1 >= index_->population() || !std::isfinite(squared_reach_);
}

/// The reach is first extended by a little. If that is not enough, the site may be far from all
/// others; then the reach is extended until kMost sites are found.
template <class Index>
void NearSites<Index>::extend() {
  const Vec3& position = index_->position(site_);
  const double farther = kFurther * squared_reach_;
  squared_reach_ = farther;
  if (++extensions_ > kFewExtensions && count_ < kMost) {
    squared_reach_ = std::nextafter(squared_distance_of_nearest(kMost + 1, position),
                                    std::numeric_limits<double>::infinity());
  }
  further_.clear();
  index_->for_each_near({position, position}, squared_reach_,
                        [&](std::int32_t site) { further_.add(site, index_->position(site)); });
  choose(further_);
}

/// The squared distance within which a point has that many sites around it; infinite if there are
/// fewer.
template <class Index>
double NearSites<Index>::squared_distance_of_nearest(std::size_t count, const Vec3& point) {
  nearest_.clear();  // a heap
  double farthest = std::numeric_limits<double>::infinity();
  index_->for_each_nearest(point, farthest, [&](std::int32_t site) {
    const double squared = (index_->position(site) - point).squaredNorm();
    if (nearest_.size() == count) {
      if (!(squared < farthest)) return;
      std::pop_heap(nearest_.begin(), nearest_.end());
      nearest_.pop_back();
    }
    nearest_.push_back(squared);
    std::push_heap(nearest_.begin(), nearest_.end());
    if (nearest_.size() == count) farthest = nearest_.front();
  });
  return farthest;
}

template <class Index>
void NearSites<Index>::put_need_away() {
  if (!(need_ > 0.0)) return;
  needs_[need_count_ % needs_.size()] = std::exchange(need_, 0.0);
  ++need_count_;
}

/// The largest reach that a site of the neighborhood needed. Isolated sites are ignored: they
/// needed far more than others and say nothing about the next ones.
template <class Index>
double NearSites<Index>::most_needed() {
  const std::span<double> needs =
      std::span(needs_).first(std::min(std::exchange(need_count_, 0), needs_.size()));
  std::sort(needs.begin(), needs.end());
  const double usual = kAlike * needs[(needs.size() - 1) / 2];
  return *std::find_if(needs.rbegin(), needs.rend(), [&](double need) { return need <= usual; });
}

template <class Index>
void NearSites<Index>::look_around(const SiteBoxes::Neighborhood& here) {
  neighborhood_ = here.number;
  if (need_count_ > 0) squared_reach_around_ = kMargin * most_needed();
  squared_reach_ = squared_reach_around_;
  const SiteBoxes::Neighborhood block = index_->block(here);
  if (block.number != block_ || squared_reach_ > squared_reach_block_) look_at(block);
  around_.clear();
  index_->for_each_near(groups_, here.box, squared_reach_,
                        [&](std::int32_t site) { around_.add(site, index_->position(site)); });
}

/// The reach of a block is a little more than this neighborhood needs, because other neighborhoods
/// of the block may need more.
template <class Index>
void NearSites<Index>::look_at(const SiteBoxes::Neighborhood& block) {
  block_ = block.number;
  squared_reach_block_ = kMargin * squared_reach_;
  groups_.clear();
  index_->for_each_group_near(block.box, squared_reach_block_,
                              [&](std::size_t group) { groups_.push_back(group); });
}

template <class Index>
void NearSites<Index>::Places::clear() {
  sites.clear();
  x.clear();
  y.clear();
  z.clear();
}

template <class Index>
void NearSites<Index>::Places::add(std::int32_t site, const Vec3& position) {
  sites.push_back(site);
  x.push_back(position.x());
  y.push_back(position.y());
  z.push_back(position.z());
}

template <class Index>
void NearSites<Index>::measure(const Places& places) {
  const std::size_t size = places.sites.size();
  if (squared_.size() < size) squared_.resize(2 * size);
  const Triple from(index_->position(site_));
  const double *const x = places.x.data(), *const y = places.y.data(), *const z = places.z.data();
  double* const squared = squared_.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double dx = x[k] - from.x, dy = y[k] - from.y, dz = z[k] - from.z;
    squared[k] = dx * dx + dy * dy + dz * dz;
  }
}

// The loop has no branch, because a processor cannot predict which positions are within reach.
template <class Index>
void NearSites<Index>::choose(const Places& places) {
  measure(places);
  const std::size_t size = places.sites.size();
  if (near_.size() < size) near_.resize(2 * size);
  const double* const squared = squared_.data();
  const std::int32_t* const sites = places.sites.data();
  const double reach = squared_reach_;
  const std::int32_t self = site_;
  Rival* const near = near_.data();
  std::size_t count = 0;
  for (std::size_t k = 0; k < size; ++k) {
    near[count].squared_distance = squared[k];
    near[count].site = sites[k];
    count += static_cast<std::size_t>((squared[k] < reach) & (sites[k] != self));
  }
  within_reach_ = count;
  if (count > kMost) {
    const auto first = near_.begin();
    for (std::size_t k = 0; k < count; ++k) near[k].original = index_->original(near[k].site);
    std::nth_element(first, first + kMost, first + static_cast<std::ptrdiff_t>(count));
    count = kMost;
  }
  count_ = count;
  for (std::size_t k = 0; k < count; ++k) near[k].original = index_->original(near[k].site);
  sort();
}

template <class Index>
void NearSites<Index>::sort() {
  if (count_ > kFew || !sort_few())
    std::sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count_));
}

/// Sort by counting nearer sites, because a processor cannot predict comparisons. Returns false and
/// changes nothing if distances are equal.
template <class Index>
bool NearSites<Index>::sort_few() {
  std::array<double, kFew> keys;
  std::array<std::int64_t, kFew> places;
  for (std::size_t k = 0; k < count_; ++k) keys[k] = near_[k].squared_distance;
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    std::int64_t nearer = 0;
    for (std::size_t other = 0; other < count_; ++other) nearer += keys[other] < keys[k] ? 1 : 0;
    places[k] = nearer;
    sum += nearer;
  }
  const auto count = static_cast<std::int64_t>(count_);
  if (2 * sum != count * (count - 1)) return false;
  std::array<Rival, kFew> found;
  std::copy_n(near_.begin(), count_, found.begin());
  for (std::size_t k = 0; k < count_; ++k) near_[static_cast<std::size_t>(places[k])] = found[k];
  return true;
}

}  // namespace dapple
