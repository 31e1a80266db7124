// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/bisectors.hpp"

#include <algorithm>
#include <limits>

#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFewRivals = 12;  // that are sorted at once: enough for most faces
// So many are more than cells have whose faces are near: then it pays to find out which matter.
constexpr std::size_t kMany = 51;

}  // namespace

Bisectors::Bisectors(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface), sites_(&sites), index_(&index), near_(surface, sites, index) {}

void Bisectors::reset(std::int32_t site, Rivals rivals) {
  const Laps::Lap lap(laps_);
  begin(site, rivals);
  if (index_->has_graph()) return take_links();
  owner_ = index_->leader(site);
  near_.turn_to(site);
  take_near();
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
  most_ = kMany;
  most_needed_ = 0.0;
  complete_ = false;
  all_ = rivals == Rivals::kAll || surface_->ordered().components() == 1;
  bisectors_.clear();
  rivals_.clear();
}

void Bisectors::look_further() {
  const Laps::Lap lap(laps_);
  if (near_.all().size() < most_)
    near_.extend();
  else if (take_all_that_cut())
    return;
  else
    most_ = 2 * most_ + 1;
  take_near();
}

/// Take what is within reach, but not more than `most_`. Which of several at the last distance are
/// among these is decided by their order: they count only when all of them are.
void Bisectors::take_near() {
  const std::span<const Rival> near = near_.all();
  const bool cut_off = near.size() >= most_ && index_->population() > most_ + 1;
  complete_ = !cut_off && near_.is_complete();
  most_needed_ =
      cut_off ? near[most_ - 1].squared_distance : std::numeric_limits<double>::infinity();
  bisectors_.clear();
  for (const Rival& rival : near) {
    if (rival.squared_distance == 0.0 && rival.original < sites_->original(owner_))
      owner_ = rival.site;
    if (rival.squared_distance < most_needed_) add(rival.site);
  }
  drop_twins();
  settle(bisectors_.size());
}

/// Most faces are decided by the nearest few of many rivals: the others need not be sorted.
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

/// Where a cell goes far beyond the site's neighbors, as it does where few sites own much, complete
/// the list without the sites that its faces are nowhere near to. False if that failed.
bool Bisectors::take_all_that_cut() {
  if (!shrink_to_cell()) return false;
  bisectors_.resize(settled_);
  for (const std::int32_t site : found_) add(first_at_place_of(site));
  sort();
  for (Bisector& b : bisectors_) b.idle = b.idle || !cell_.touches(b.normal, b.offset);
  settle(bisectors_.size());
  complete_ = true;
  return true;
}

// A convex polyhedron belongs to the site if its vertices do: wherever another site is nearer to
// one, that site's bisector cuts it off.
bool Bisectors::shrink_to_cell() {
  found_.clear();
  if (box_.isEmpty())
    for (std::size_t v = 0; v < surface_->vertex_count(); ++v)
      box_.extend(surface_->ordered().vertex(static_cast<std::int32_t>(v)));
  const Vec3& position = sites_->position(site_);
  cell_.start({box_.min() - position, box_.max() - position});
  const auto cut = [this](const Bisector& b) {
    return !cell_.is_cut_by(b.normal, b.offset) || cell_.cut(b.normal, b.offset);
  };
  for (std::size_t k = 0; k < settled_; ++k)
    if (!bisectors_[k].idle && !cut(bisectors_[k])) return false;
  while (const std::optional<Vec3> vertex = cell_.next_vertex()) {
    const std::int32_t nearest = index_->nearest(position + *vertex, site_);
    const Bisector b = bisector_to(nearest);
    if (b.idle) return false;
    if (!cell_.is_cut_by(b.normal, b.offset)) continue;
    if (!cell_.cut(b.normal, b.offset)) return false;
    found_.push_back(nearest);
  }
  return true;
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
  for (const auto& [original, d] : index_->links(site_)) {
    const std::int32_t site = index_->ordered(original);
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

/// Whether straight distance to a site goes through a wall or over a gap. What it would cut off
/// would be given back to this component's sites, face by face, since it is not covered then.
bool Bisectors::is_out_of_sight(std::int32_t other) const {
  if (all_) return false;
  const OrderedSurface& mesh = surface_->ordered();
  const OrderedFace own = sites_->faces[static_cast<std::size_t>(site_)];
  const OrderedFace theirs = sites_->faces[static_cast<std::size_t>(other)];
  return mesh.component(own) != mesh.component(theirs) &&
         mesh.geometry(own).normal.dot(mesh.geometry(theirs).normal) < 0.0;
}

void Bisectors::sort() {
  std::sort(bisectors_.begin(), bisectors_.end(), [&](const Bisector& a, const Bisector& b) {
    return a.squared_distance != b.squared_distance
               ? a.squared_distance < b.squared_distance
               : sites_->original(a.site) < sites_->original(b.site);
  });
  drop_twins();
}

// Of coincident sites the first of the caller's owns the cell. The others share its plane; where
// rounding lets theirs cut once more, the boundary would bear the name of an empty cell.
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
