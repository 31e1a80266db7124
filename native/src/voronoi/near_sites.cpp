// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/near_sites.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/triple.hpp"

namespace dapple {
namespace {

constexpr double kFirstReach = 1.8;  // spacings
constexpr double kFurther = 2.25;    // factor of the squared reach
constexpr int kFewExtensions = 2;    // of one site, before it searches on its own
constexpr double kMargin = 1.25;     // of the squared reach that the last neighborhood needed
constexpr double kAlike = 4.0;       // largest representative need, relative to the median
constexpr std::size_t kNone = ~std::size_t{0};
constexpr std::size_t kFew = 24;

}  // namespace

NearSites::NearSites(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface), sites_(&sites), index_(&index) {
  restart();
}

void NearSites::restart() {
  const double reach = kFirstReach * surface_->spacing(sites_->size());
  squared_reach_around_ = reach * reach;
  neighborhood_ = block_ = kNone;
  need_ = 0.0;
  need_count_ = 0;
}

void NearSites::turn_to(std::int32_t site) {
  put_need_away();
  site_ = site;
  extensions_ = 0;
  const SiteIndex::Neighborhood here = index_->neighborhood(site);
  if (here.number != neighborhood_) look_around(here);
  squared_reach_ = squared_reach_around_;
  choose(around_);
}

bool NearSites::is_complete() const {
  return within_reach_ + 1 >= index_->population() || !std::isfinite(squared_reach_);
}

/// The reach is first extended by a little. If that is not enough, the site may be far from all
/// others; then the reach is extended until kMost sites are found.
void NearSites::extend() {
  const Vec3& position = sites_->position(site_);
  const double farther = kFurther * squared_reach_;
  squared_reach_ = farther;
  if (++extensions_ > kFewExtensions && count_ < kMost) {
    const double enough = index_->squared_distance_of_nearest(kMost + 1, position, nearest_);
    squared_reach_ = std::nextafter(enough, std::numeric_limits<double>::infinity());
  }
  further_.clear();
  index_->for_each_near({position, position}, squared_reach_,
                        [&](std::int32_t site) { further_.add(site, sites_->position(site)); });
  choose(further_);
}

void NearSites::put_need_away() {
  if (!(need_ > 0.0)) return;
  needs_[need_count_ % needs_.size()] = std::exchange(need_, 0.0);
  ++need_count_;
}

/// The largest reach that a site of the neighborhood needed. Isolated sites are ignored: they
/// needed far more than others and say nothing about the next ones.
double NearSites::most_needed() {
  const std::span<double> needs =
      std::span(needs_).first(std::min(std::exchange(need_count_, 0), needs_.size()));
  std::sort(needs.begin(), needs.end());
  const double usual = kAlike * needs[(needs.size() - 1) / 2];
  return *std::find_if(needs.rbegin(), needs.rend(), [&](double need) { return need <= usual; });
}

void NearSites::look_around(const SiteIndex::Neighborhood& here) {
  neighborhood_ = here.number;
  if (need_count_ > 0) squared_reach_around_ = kMargin * most_needed();
  squared_reach_ = squared_reach_around_;
  const SiteIndex::Neighborhood block = index_->block(here);
  if (block.number != block_ || squared_reach_ > squared_reach_block_) look_at(block);
  around_.clear();
  index_->for_each_near(groups_, here.box, squared_reach_,
                        [&](std::int32_t site) { around_.add(site, sites_->position(site)); });
}

/// The reach of a block is a little more than this neighborhood needs, because other neighborhoods
/// of the block may need more.
void NearSites::look_at(const SiteIndex::Neighborhood& block) {
  block_ = block.number;
  squared_reach_block_ = kMargin * squared_reach_;
  groups_.clear();
  index_->for_each_group_near(block.box, squared_reach_block_,
                              [&](std::size_t group) { groups_.push_back(group); });
}

void NearSites::Places::clear() {
  sites.clear();
  x.clear();
  y.clear();
  z.clear();
}

void NearSites::Places::add(std::int32_t site, const Vec3& position) {
  sites.push_back(site);
  x.push_back(position.x());
  y.push_back(position.y());
  z.push_back(position.z());
}

void NearSites::measure(const Places& places) {
  const std::size_t size = places.sites.size();
  if (squared_.size() < size) squared_.resize(2 * size);
  const Triple from(sites_->position(site_));
  const double *const x = places.x.data(), *const y = places.y.data(), *const z = places.z.data();
  double* const squared = squared_.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double dx = x[k] - from.x, dy = y[k] - from.y, dz = z[k] - from.z;
    squared[k] = dx * dx + dy * dy + dz * dz;
  }
}

// The loop has no branch, because a processor cannot predict which positions are within reach.
void NearSites::choose(const Places& places) {
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
    for (std::size_t k = 0; k < count; ++k) near[k].original = sites_->original(near[k].site);
    std::nth_element(first, first + kMost, first + static_cast<std::ptrdiff_t>(count));
    count = kMost;
  }
  count_ = count;
  for (std::size_t k = 0; k < count; ++k) near[k].original = sites_->original(near[k].site);
  sort();
}

void NearSites::sort() {
  if (count_ > kFew || !sort_few())
    std::sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count_));
}

/// Sort by counting nearer sites, because a processor cannot predict comparisons. Returns false and
/// changes nothing if distances are equal.
bool NearSites::sort_few() {
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
