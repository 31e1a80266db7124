// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/bisectors.hpp"

#include <algorithm>
#include <limits>

#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFewRivals = 12;  // sites that are sorted first: enough for most faces
// Cells whose faces are all near the site have fewer bisectors; beyond this number, sites are
// searched for at each face.
constexpr std::size_t kMany = NearSites<SiteIndex>::kMost;
// Rounding error of a squared distance, so that a face that lies in a bisector is found from both
// sites.
constexpr double kTie = 1e-13;

}  // namespace

Bisectors::Bisectors(const Surface& surface, const OrderedSites& sites, const SiteIndex& index,
                     const OrderedLinks* links)
    : surface_(&surface),
      sites_(&sites),
      index_(&index),
      links_(links),
      near_(index, surface.spacing(sites.size())) {}

void Bisectors::reset(std::int32_t site, Rivals rivals) {
  const Laps::Lap lap(laps_);
  begin(site, rivals);
  if (links_ && links_->known()) return take_links();
  owner_ = index_->leader(site);
  near_.turn_to(site);
  take_near();
}

void Bisectors::reset_far(std::int32_t site) {
  begin(site, Rivals::kAll);
  owner_ = first_at_place_of(site);
  ended_ = true;
}

void Bisectors::reset_among(std::int32_t site, std::span<const std::int32_t> others) {
  begin(site, Rivals::kAll);
  complete_ = true;
  for (const std::int32_t other : others)
    if (other != site) rivals_.push_back(rival(other));
}

void Bisectors::begin(std::int32_t site, Rivals rivals) {
  site_ = owner_ = site;
  settled_ = next_rival_ = 0;
  most_needed_ = 0.0;
  complete_ = ended_ = false;
  all_ = rivals == Rivals::kAll || surface_->ordered().components() == 1;
  bisectors_.clear();
  rivals_.clear();
}

void Bisectors::look_further() {
  const Laps::Lap lap(laps_);
  ended_ = near_.all().size() >= kMany;
  if (ended_) return;
  near_.extend();
  take_near();
}

/// Add the sites within reach, but fewer than kMany. Sites at the largest distance are added only
/// if all of them fit, because their order is arbitrary.
void Bisectors::take_near() {
  const std::span<const Rival> near = near_.all();
  const bool cut_off = near.size() >= kMany && index_->population() > kMany + 1;
  complete_ = !cut_off && near_.is_complete();
  most_needed_ =
      cut_off ? near[kMany - 1].squared_distance : std::numeric_limits<double>::infinity();
  bisectors_.clear();
  for (const Rival& rival : near) {
    if (rival.squared_distance == 0.0 && rival.original < sites_->original(owner_))
      owner_ = rival.site;
    if (rival.squared_distance < most_needed_) add(rival.site);
  }
  drop_twins();
  settle(bisectors_.size());
}

/// On most faces only the nearest few of many rivals matter, so the others need not be sorted.
void Bisectors::take_rivals() {
  const auto first = rivals_.begin() + static_cast<std::ptrdiff_t>(next_rival_);
  const std::size_t count = std::min(kFewRivals, rivals_.size() - next_rival_);
  const auto last = first + static_cast<std::ptrdiff_t>(count);
  if (last != rivals_.end()) std::nth_element(first, last, rivals_.end());
  std::sort(first, last);
  for (auto rival = first; rival != last; ++rival) add(rival->site);
  next_rival_ += count;
  drop_twins();
  settle(bisectors_.size());
}

// Ties count, so that a face in a bisector is assigned to one of both sites.
std::size_t Bisectors::nearest_to(const Vec3& point, std::span<const std::int32_t> others) {
  const Laps::Lap lap(laps_);
  const Vec3& position = sites_->position(site_);
  const std::int32_t found = index_->nearest_of(
      position + point, (1.0 + kTie) * point.squaredNorm(), [&](std::int32_t site) {
        const auto is_there = [&](std::int32_t k) {  // coincident sites have one bisector
          return sites_->position(bisectors_[static_cast<std::size_t>(k)].site) ==
                 sites_->position(site);
        };
        return sites_->position(site) != position && !is_near(site) && !is_out_of_sight(site) &&
               std::none_of(others.begin(), others.end(), is_there);
      });
  return found < 0 ? kNone : place_of(first_at_place_of(found));
}

bool Bisectors::is_near(std::int32_t other) const {
  return (sites_->position(other) - sites_->position(site_)).squaredNorm() < most_needed_;
}

/// Add the bisector with a site unless it has been added.
std::size_t Bisectors::place_of(std::int32_t site) {
  const auto here = std::find_if(bisectors_.begin(), bisectors_.end(),
                                 [site](const Bisector& b) { return b.site == site; });
  const auto k = static_cast<std::size_t>(here - bisectors_.begin());
  if (here == bisectors_.end()) add(site);
  return k;
}

std::int32_t Bisectors::first_at_place_of(std::int32_t site) const {
  const Vec3& place = sites_->position(site);
  index_->for_each_near(
      {place, place}, std::numeric_limits<double>::min(), [&](std::int32_t other) {
        if (sites_->position(other) == place && sites_->original(other) < sites_->original(site))
          site = other;
      });
  return site;
}

void Bisectors::take_links() {
  bisectors_.clear();
  for (const auto& [original, d] : links_->of(site_)) {
    const std::int32_t site = links_->ordered(original);
    bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), site});
    if (d.squaredNorm() == 0.0 && original < sites_->original(owner_)) owner_ = site;
  }
  settle(bisectors_.size());
  complete_ = true;
}

Rival Bisectors::rival(std::int32_t other) const {
  return {(sites_->position(other) - sites_->position(site_)).squaredNorm(),
          sites_->original(other), other};
}

Bisector Bisectors::bisector_to(std::int32_t other) const {
  const Vec3 d = sites_->position(other) - sites_->position(site_);
  return {d, 0.5 * d.squaredNorm(), d.squaredNorm(), other, is_out_of_sight(other)};
}

/// Whether the straight line to a site passes through a wall or over a gap. The part that its
/// bisector would cut off would be uncovered and returned to this component's sites, face by face.
bool Bisectors::is_out_of_sight(std::int32_t other) const {
  if (all_) return false;
  const OrderedSurface& mesh = surface_->ordered();
  const OrderedFace own = sites_->faces[static_cast<std::size_t>(site_)];
  const OrderedFace theirs = sites_->faces[static_cast<std::size_t>(other)];
  return mesh.component(own) != mesh.component(theirs) &&
         mesh.geometry(own).normal.dot(mesh.geometry(theirs).normal) < 0.0;
}

// The first of coincident sites, in the caller's order, owns the cell. The others have the same
// bisector; if it cut once more because of rounding, the boundary would refer to an empty cell.
void Bisectors::drop_twins() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < bisectors_.size(); ++k) {
    const Bisector& b = bisectors_[k];
    bool twin = false;
    for (std::size_t p = kept; p > 0 && bisectors_[p - 1].squared_distance == b.squared_distance;
         --p)
      twin = twin || (b.squared_distance > 0.0 && bisectors_[p - 1].normal == b.normal);
    if (twin) continue;
    if (kept != k) bisectors_[kept] = b;
    ++kept;
  }
  bisectors_.resize(kept);
}

void Bisectors::settle(std::size_t count) {
  settled_ = count;
  for (std::size_t k = 0; k < count; ++k)
    half_spaces_.assign(k, bisectors_[k].normal, bisectors_[k].offset);
}

}  // namespace dapple
