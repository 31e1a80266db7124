// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/bisectors.hpp"

#include <algorithm>

#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kFirstNeighbors = 12;  // enough for most cells; more are fetched on demand
// So many are more than cells have whose faces are near: then it pays to find out which matter.
constexpr std::size_t kMany = 50;

}  // namespace

void Bisectors::reset(std::int32_t site) {
  site_ = site;
  fetched_ = 0;
  rivals_.clear();
  next_rival_ = 0;
  if (index_->has_graph())
    take_links();
  else
    fetch(kFirstNeighbors + 1);
}

// All sites may be at one place: any lower one settles that this is not the owner.
std::int32_t Bisectors::owner() {
  std::int32_t best = index_->leader(site_);
  if (best != site_) return best;
  const auto look_at = [&](std::int32_t site, double squared_distance) {
    if (squared_distance == 0.0 && sites_->original(site) < sites_->original(best)) best = site;
  };
  if (index_->has_graph()) {
    for (const Bisector& b : bisectors_) look_at(b.site, b.squared_distance);
    return best;
  }
  while (true) {
    for (const Neighbor& found : found_) look_at(found.index, found.squared_distance);
    if (best != site_ || fetched_ == index_->population() || found_.back().squared_distance > 0.0)
      return best;
    fetch(2 * fetched_);
  }
}

void Bisectors::reset_among(std::int32_t site, std::span<const std::int32_t> others) {
  site_ = site;
  fetched_ = index_->population();
  bisectors_.clear();
  settled_ = 0;
  rivals_.clear();
  next_rival_ = 0;
  const Vec3& position = sites_->position(site);
  for (const std::int32_t other : others)
    if (other != site)
      rivals_.push_back(
          {(sites_->position(other) - position).squaredNorm(), sites_->original(other), other});
}

/// Most faces are decided by the nearest few of many rivals: the others need not be sorted.
void Bisectors::take_rivals() {
  const auto first = rivals_.begin() + static_cast<std::ptrdiff_t>(next_rival_);
  const std::size_t count = std::min(kFirstNeighbors, rivals_.size() - next_rival_);
  const auto last = first + static_cast<std::ptrdiff_t>(count);
  if (last != rivals_.end()) std::nth_element(first, last, rivals_.end());
  std::sort(first, last);
  for (auto rival = first; rival != last; ++rival) add(rival->site);
  next_rival_ += count;
  drop_twins();
  settled_ = bisectors_.size();
}

void Bisectors::fetch(std::size_t count) {
  index_->nearest(sites_->position(site_), count, found_);
  fetched_ = found_.size();
  bisectors_.clear();
  for (const Neighbor& found : found_)
    if (found.index != site_) add(found.index);
  sort();
  settle();
}

void Bisectors::fetch_more() {
  if (fetched_ < kMany || !take_all_that_cut()) fetch(2 * fetched_);
}

/// Where a cell goes far beyond the site's neighbors, as it does where few sites own much, complete
/// the list without the sites that its faces are nowhere near to. False if that failed.
bool Bisectors::take_all_that_cut() {
  std::vector<std::int32_t> found;
  if (!shrink_to_cell(found)) return false;
  bisectors_.resize(settled_);
  for (const std::int32_t site : found) add(first_at_place_of(site));
  sort();
  for (Bisector& b : bisectors_) b.idle = !cell_.touches(b.normal, b.offset);
  settled_ = bisectors_.size();
  fetched_ = index_->population();
  return true;
}

// A convex polyhedron belongs to the site if its vertices do: wherever another site is nearer to
// one, that site's bisector cuts it off. `found` are the sites that are not in the list.
bool Bisectors::shrink_to_cell(std::vector<std::int32_t>& found) {
  if (box_.isEmpty())
    for (std::size_t v = 0; v < surface_->vertex_count(); ++v)
      box_.extend(surface_->ordered().vertex(static_cast<std::int32_t>(v)));
  const Vec3& position = sites_->position(site_);
  cell_.start({box_.min() - position, box_.max() - position});
  const auto cut = [this](const Bisector& b) {
    return !cell_.is_cut_by(b.normal, b.offset) || cell_.cut(b.normal, b.offset);
  };
  for (std::size_t k = 0; k < settled_; ++k)
    if (!cut(bisectors_[k])) return false;
  while (const std::optional<Vec3> vertex = cell_.next_vertex()) {
    const std::int32_t nearest = index_->nearest(position + *vertex, site_);
    const Bisector b = bisector_to(nearest);
    if (!cell_.is_cut_by(b.normal, b.offset)) continue;
    if (!cell_.cut(b.normal, b.offset)) return false;
    found.push_back(nearest);
  }
  return true;
}

std::int32_t Bisectors::first_at_place_of(std::int32_t site) {
  const auto lower = [this](std::int32_t a, std::int32_t b) {
    return sites_->original(a) < sites_->original(b);
  };
  for (std::size_t count = 2;; count *= 2) {
    index_->nearest(sites_->position(site), count, found_);
    for (const Neighbor& found : found_)
      if (found.squared_distance == 0.0) site = std::min(site, found.index, lower);
    if (found_.size() < count || found_.back().squared_distance > 0.0) return site;
  }
}

void Bisectors::take_links() {
  bisectors_.clear();
  for (const auto& [site, d] : index_->links(site_))
    bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), index_->ordered(site)});
  settled_ = bisectors_.size();
  fetched_ = index_->population();
}

Bisector Bisectors::bisector_to(std::int32_t other) const {
  const Vec3 d = sites_->position(other) - sites_->position(site_);
  return {d, 0.5 * d.squaredNorm(), d.squaredNorm(), other};
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
    if (!twin) bisectors_[kept++] = b;
  }
  bisectors_.resize(kept);
}

// Which of several sites at the last distance were found is an accident of the tree: they count
// only when a longer list has found all of them.
void Bisectors::settle() {
  settled_ = bisectors_.size();
  if (fetched_ == index_->population() || bisectors_.empty()) return;
  const double last = found_.back().squared_distance;
  while (settled_ > 0 && bisectors_[settled_ - 1].squared_distance >= last) --settled_;
}

}  // namespace dapple
