// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/site_index.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/morton.hpp"
#include "base/reorder.hpp"
#include "base/vectors.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kCrowd = 16;    // sites on one face: smaller groups are searched linearly
constexpr std::size_t kMany = 8;      // sites on one face, on average
constexpr std::size_t kCounted = 16;  // faces per site
constexpr std::size_t kFew = 1024;    // sites: below this the order does not matter
constexpr double kLoose = 4.0;        // relative to leaves of sites that are spread out

}  // namespace

void OrderedSites::assign(const Surface& surface, const Sites& sites) {
  callers_.resize(sites.size());
  for_each_vector(sites.size(), [&](std::size_t k) {
    callers_[k] = surface.ordered().counted_face(sites.faces[k]);
  });
  order_by_face(surface.face_count());
  positions.resize(sites.size());
  faces.resize(sites.size());
  for_each_vector(sites.size(), [&](std::size_t k) {
    const auto caller = static_cast<std::size_t>(originals[k]);
    positions[k] = sites.positions[caller];
    faces[k] = callers_[caller];
  });
}

void OrderedSites::move(const Surface& surface, const Sites& sites) {
  for_each_vector(sites.size(), [&](std::size_t k) {
    const auto caller = static_cast<std::size_t>(originals[k]);
    positions[k] = sites.positions[caller];
    faces[k] = surface.ordered().counted_face(sites.faces[caller]);
  });
}

/// Sort the sites by face and index. The sites on each face are counted unless there are far more
/// faces than sites.
void OrderedSites::order_by_face(std::size_t face_count) {
  originals.resize(callers_.size());
  if (face_count > kCounted * callers_.size()) {
    std::iota(originals.begin(), originals.end(), 0);
    std::sort(originals.begin(), originals.end(), [&](std::int32_t a, std::int32_t b) {
      const OrderedFace on_a = callers_[static_cast<std::size_t>(a)];
      const OrderedFace on_b = callers_[static_cast<std::size_t>(b)];
      return on_a != on_b ? on_a < on_b : a < b;
    });
    return;
  }
  next_.assign(face_count + 1, 0);
  for (const OrderedFace face : callers_) ++next_[as_index(face) + 1];
  std::partial_sum(next_.begin(), next_.end(), next_.begin());
  for (std::size_t k = 0; k < callers_.size(); ++k)
    originals[static_cast<std::size_t>(next_[as_index(callers_[k])]++)] =
        static_cast<std::int32_t>(k);
}

void SiteIndex::update() {
  leaders_.clear();
  kept_.clear();
  places_.clear();
  leave_crowds_out();
  const bool spread = are_spread();
  if (!spread || !kept_.empty()) sort_in_space(!spread);
  boxes_.assign(kept_.empty() ? sites_->positions : kept_positions_);
  if (!kept_.empty() || !are_off_their_faces()) return;
  sort_in_space(/*anew=*/true);
  boxes_.assign(kept_positions_);
}

void SiteIndex::refit() {
  for (std::size_t k = 0; k < kept_.size(); ++k) kept_positions_[k] = sites_->position(kept_[k]);
  boxes_.assign(kept_.empty() ? sites_->positions : kept_positions_);
}

// Sites are sorted by face and caller's index, so the sites of a face are contiguous.
void SiteIndex::leave_crowds_out() {
  const std::vector<OrderedFace>& faces = sites_->faces;
  for (std::size_t first = 0, last = 0; first < faces.size(); first = last) {
    while (last < faces.size() && faces[last] == faces[first]) ++last;
    if (last - first >= kCrowd) find_crowds(first, last);
  }
  for (std::size_t k = 0; k < leaders_.size(); ++k)
    if (leaders_[k] == static_cast<std::int32_t>(k)) kept_.push_back(static_cast<std::int32_t>(k));
}

/// Sorting by face also sorts the sites in space, unless a face holds many sites.
bool SiteIndex::are_spread() const {
  std::size_t occupied = 0;
  for (std::size_t k = 0; k < sites_->size(); ++k)
    occupied += k == 0 || sites_->faces[k] != sites_->faces[k - 1] ? 1 : 0;
  return sites_->size() <= kMany * occupied;
}

/// Whether the order of the faces is not an order in space; then leaves are far too large.
bool SiteIndex::are_off_their_faces() const {
  const std::size_t count = sites_->size();
  if (count < kFew) return false;
  Eigen::AlignedBox3d all;
  double sum = 0.0;
  for (std::size_t k = 0; k < count; k += SiteBoxes::kFan) {
    const Box leaf = boxes_.leaf_of(k);
    sum += (leaf.high - leaf.low).norm();
    all.extend(leaf.low).extend(leaf.high);
  }
  const double share = static_cast<double>(SiteBoxes::kFan) / static_cast<double>(count);
  return sum * share > kLoose * std::sqrt(share) * all.diagonal().norm();
}

/// \param anew whether to sort the sites again
void SiteIndex::sort_in_space(bool anew) {
  if (kept_.empty()) {
    kept_.resize(sites_->size());
    std::iota(kept_.begin(), kept_.end(), 0);
  }
  kept_positions_ = gather(std::span<const Vec3>(sites_->positions), kept_);
  if (anew) {
    const std::vector<std::int32_t> order = morton_order(kept_positions_);
    kept_ = gather(std::span<const std::int32_t>(kept_), order);
    kept_positions_ = gather(std::span<const Vec3>(kept_positions_), order);
  }
  places_.assign(sites_->size(), 0);
  for (std::size_t k = 0; k < kept_.size(); ++k)
    places_[static_cast<std::size_t>(kept_[k])] = static_cast<std::int32_t>(k);
}

/// Set the leaders of sites in [first, last) that coincide with others.
void SiteIndex::find_crowds(std::size_t first, std::size_t last) {
  std::vector<std::pair<std::array<double, 3>, std::size_t>> run;
  for (std::size_t k = first; k < last; ++k) {
    const Vec3& p = sites_->positions[k];
    run.push_back({{p.x(), p.y(), p.z()}, k});
  }
  std::sort(run.begin(), run.end());
  for (std::size_t k = 1; k < run.size(); ++k) {
    if (run[k].first != run[k - 1].first) continue;
    if (leaders_.empty()) {
      leaders_.resize(sites_->size());
      std::iota(leaders_.begin(), leaders_.end(), 0);
    }
    leaders_[run[k].second] = leaders_[run[k - 1].second];
  }
}

std::int32_t SiteIndex::nearest(const Vec3& point, std::int32_t otherwise) const {
  std::int32_t best = -1;
  double least = std::numeric_limits<double>::infinity();
  boxes_.for_each_nearest({point, point}, least, [&](std::size_t k) {
    const std::int32_t site = site_in_boxes(k);
    const double squared = squared_distance(point, site);
    if (best >= 0 && !(squared < least)) return;
    least = squared;
    best = site;
  });
  return best >= 0 ? best : otherwise;
}

}  // namespace dapple
