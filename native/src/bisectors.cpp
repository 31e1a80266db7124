// SPDX-License-Identifier: GPL-3.0-or-later
#include "bisectors.hpp"

#include <algorithm>

namespace dapple {
namespace {

constexpr std::size_t kFirstNeighbours = 12;  // enough for most cells; more are fetched on demand

}  // namespace

void Bisectors::reset(std::int32_t site) {
  site_ = site;
  fetched_ = 0;
  rivals_.clear();
  next_rival_ = 0;
  if (index_->has_graph())
    take_links();
  else
    fetch(kFirstNeighbours + 1);
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
    for (const Neighbour& found : found_) look_at(found.index, found.squared_distance);
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
  const std::size_t count = std::min(kFirstNeighbours, rivals_.size() - next_rival_);
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
  for (const Neighbour& found : found_)
    if (found.index != site_) add(found.index);
  sort();
  settle();
}

void Bisectors::take_links() {
  bisectors_.clear();
  for (const auto& [site, d] : index_->links(site_))
    bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), index_->ordered(site)});
  settled_ = bisectors_.size();
  fetched_ = index_->population();
}

void Bisectors::add(std::int32_t other) {
  const Vec3 d = sites_->position(other) - sites_->position(site_);
  bisectors_.push_back({d, 0.5 * d.squaredNorm(), d.squaredNorm(), other});
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
