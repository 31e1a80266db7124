// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/near_sites.hpp"

#include <cmath>
#include <utility>

namespace dapple {
namespace {

constexpr double kFirstReach = 1.8;  // spacings
constexpr double kFurther = 2.25;    // squared
constexpr double kMargin = 1.25;     // of the squared reach that the last neighborhood needed
constexpr std::size_t kNone = ~std::size_t{0};

}  // namespace

NearSites::NearSites(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface), sites_(&sites), index_(&index) {
  restart();
}

void NearSites::restart() {
  const double reach = kFirstReach * surface_->spacing(sites_->size());
  squared_reach_around_ = reach * reach;
  neighborhood_ = kNone;
  needed_ = 0.0;
}

void NearSites::turn_to(std::int32_t site) {
  site_ = site;
  const SiteIndex::Neighborhood here = index_->neighborhood(site);
  if (here.number != neighborhood_) look_around(here);
  squared_reach_ = squared_reach_around_;
  choose(around_);
}

bool NearSites::is_complete() const {
  return near_.size() + 1 >= index_->population() || !std::isfinite(squared_reach_);
}

void NearSites::extend() {
  squared_reach_ *= kFurther;
  const Vec3& position = sites_->position(site_);
  find({position, position}, further_);
  choose(further_);
}

void NearSites::look_around(const SiteIndex::Neighborhood& here) {
  neighborhood_ = here.number;
  if (needed_ > 0.0) squared_reach_around_ = kMargin * std::exchange(needed_, 0.0);
  squared_reach_ = squared_reach_around_;
  find(here.box, around_);
}

void NearSites::find(const Box& query, std::vector<Place>& found) const {
  found.clear();
  index_->for_each_near(query, squared_reach_, [&](std::int32_t other) {
    found.push_back({sites_->position(other), other});
  });
}

/// Without a branch: whether a place is within reach is hard to foretell.
void NearSites::choose(const std::vector<Place>& places) {
  near_.resize(places.size());
  const Vec3 position = sites_->position(site_);
  std::size_t count = 0;
  for (const Place& place : places) {
    const double squared = (place.position - position).squaredNorm();
    near_[count] = {squared, 0, place.site};
    count += static_cast<std::size_t>((squared < squared_reach_) & (place.site != site_));
  }
  near_.resize(count);
  for (Rival& near : near_) near.original = sites_->original(near.site);
  std::sort(near_.begin(), near_.end());
}

}  // namespace dapple
