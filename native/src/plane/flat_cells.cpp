// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/flat_cells.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/hexagonal.hpp"

namespace dapple {
namespace {

constexpr double kFirstReach = 1.8;  // spacings
constexpr double kFurther = 2.25;    // factor of the squared reach
constexpr double kMargin = 1.25;     // of the squared reach that the last neighborhood needed
// Cells with more near sites than this are unusual; for them, the sites nearest to the corners are
// searched.
constexpr std::size_t kMany = 50;
constexpr std::size_t kNone = ~std::size_t{0};
constexpr std::int32_t kFrame = -1;  // label of the edges along the frame

Box box_at(const Vec3& p) { return {p, p}; }

auto key(const SiteGraph::Link& link) {
  return std::tuple(link.offset.squaredNorm(), link.site, link.offset.x(), link.offset.y());
}

}  // namespace

bool FlatCells::Rival::operator<(const Rival& other) const {
  if (squared_distance != other.squared_distance) return squared_distance < other.squared_distance;
  return std::tuple(site, offset.x(), offset.y()) <
         std::tuple(other.site, other.offset.x(), other.offset.y());
}

FlatCells::FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame)
    : FlatCells(sites, frame, frame.volume()) {}

FlatCells::FlatCells(const FlatSites& sites) : FlatCells(sites, Eigen::AlignedBox2d(), 1.0) {}

FlatCells::FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame, double area)
    : sites_(&sites), frame_(frame), neighborhood_(kNone) {
  const double reach = kFirstReach * hexagonal_spacing(area / static_cast<double>(sites.size()));
  squared_reach_around_ = reach * reach;
}

void FlatCells::turn_to(std::size_t place) {
  place_ = place;
  begin();
  if (sites_->neighborhood(place) != neighborhood_) look_around();
  squared_reach_ = squared_reach_around_;
  choose(around_);
  if (!cut_by_near()) cut_by_nearest_to_corners();
  collect_links();
}

bool FlatCells::at_frame() const {
  return std::any_of(cell_.corners.begin(), cell_.corners.end(),
                     [](const auto& corner) { return corner.edge == kFrame; });
}

// On the torus, the bisectors with the site's own images limit the cell to half a period; the
// diagonal images never cut it.
void FlatCells::begin() {
  next_ = 0;
  cutting_.clear();
  if (!sites_->periodic()) {
    const Vec2 x = sites_->place(place_).head<2>();
    const Vec2 low = frame_.min() - x, high = frame_.max() - x;
    cell_.corners = {{low, kFrame},
                     {{high.x(), low.y()}, kFrame},
                     {high, kFrame},
                     {{low.x(), high.y()}, kFrame}};
    return;
  }
  for (const Vec2& way : {Vec2(0, -1), Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0)})
    cutting_.push_back({1.0, sites_->site(place_), way});
  cell_.corners = {{{-0.5, -0.5}, 0}, {{0.5, -0.5}, 1}, {{0.5, 0.5}, 2}, {{-0.5, 0.5}, 3}};
}

// ---- who is near ----

void FlatCells::look_around() {
  neighborhood_ = sites_->neighborhood(place_);
  if (needed_ > 0.0) squared_reach_around_ = kMargin * std::exchange(needed_, 0.0);
  squared_reach_ = squared_reach_around_;
  find(sites_->box_around(place_), around_);
}

void FlatCells::find(const Box& query, std::vector<Place>& found) const {
  found.clear();
  sites_->for_each_near(query, squared_reach_, [&](std::size_t k, const Vec3& shift) {
    const Vec3 position = sites_->place(k) + shift;
    found.push_back({position.head<2>(), sites_->site(k)});
  });
}

/// The loop has no branch, because a processor cannot predict whether a position is within reach.
void FlatCells::choose(const std::vector<Place>& places) {
  if (found_.size() < places.size()) found_.resize(2 * places.size());
  const Vec2 x = sites_->place(place_).head<2>();
  const std::int32_t own = sites_->site(place_);
  std::size_t count = 0;
  for (const Place& place : places) {
    const Vec2 offset = place.position - x;
    const double squared = offset.squaredNorm();
    found_[count] = {squared, place.site, offset};
    count += static_cast<std::size_t>((squared < squared_reach_) & (place.site != own));
  }
  near_ = std::span(found_).first(count);
  std::sort(near_.begin(), near_.end());
}

// ---- clipping of the cell ----

/// Returns false if sites that were not found here might cut the cell.
bool FlatCells::cut_by_near() {
  double needed = 4.0 * cell_.squared_radius();
  for (;; choose(further_)) {
    for (; next_ < std::min(kMany, near_.size()); ++next_) {
      if (near_[next_].squared_distance > needed) break;
      if (cut(near_[next_])) needed = 4.0 * cell_.squared_radius();
    }
    const bool many = near_.size() > kMany;
    const double known = many ? near_[kMany].squared_distance : squared_reach_;
    needed_ = std::max(needed_, std::min(needed, known));
    if (needed < known || !std::isfinite(known)) return true;
    if (many) return false;
    squared_reach_ *= kFurther;
    find(box_at(sites_->place(place_)), further_);
  }
}

// A convex polygon belongs to the site if all its corners do. If another site is nearer to a
// corner, its bisector cuts the corner off. A site cuts twice only because of rounding.
void FlatCells::cut_by_nearest_to_corners() {
  for (std::size_t c = 0; c < cell_.corners.size();) {
    const Rival nearest = nearest_to(cell_.corners[c].x);
    const bool known = nearest.site == sites_->site(place_) ||
                       std::any_of(cutting_.begin(), cutting_.end(), [&](const Rival& rival) {
                         return rival.site == nearest.site && rival.offset == nearest.offset;
                       });
    c = !known && cut(nearest) ? 0 : c + 1;
  }
}

/// The site nearest to a corner; the site itself if no other one is nearer.
FlatCells::Rival FlatCells::nearest_to(const Vec2& corner) const {
  const Vec3& x = sites_->place(place_);
  const Vec3 point = x + Vec3(corner.x(), corner.y(), 0.0);
  const std::int32_t own = sites_->site(place_);
  Rival best{0.0, own, Vec2::Zero()};
  double least = corner.squaredNorm();
  sites_->for_each_nearest(point, least, [&](std::size_t k, const Vec3& shift) {
    const Vec3 position = sites_->place(k) + shift;
    const Vec2 offset = (position - x).head<2>();
    const double squared = (offset - corner).squaredNorm();
    if (!(squared < least) || sites_->site(k) == own) return;
    least = squared;
    best = {offset.squaredNorm(), sites_->site(k), offset};
  });
  return best;
}

bool FlatCells::cut(const Rival& rival) {
  if (!cell_.cut(rival.offset, 0.5 * rival.squared_distance,
                 static_cast<std::int32_t>(cutting_.size())))
    return false;
  cutting_.push_back(rival);
  return true;
}

/// Collect the sites that bound the cell. If nothing of it is left because of rounding, collect all
/// sites that have cut it.
void FlatCells::collect_links() {
  links_.clear();
  const auto add = [&](const Rival& rival) {
    links_.push_back({rival.site, Vec3(rival.offset.x(), rival.offset.y(), 0.0)});
  };
  if (cell_.corners.empty()) std::for_each(cutting_.begin(), cutting_.end(), add);
  for (const FlatPolygon::Corner& corner : cell_.corners)
    if (corner.edge != kFrame) add(cutting_[static_cast<std::size_t>(corner.edge)]);
  std::sort(links_.begin(), links_.end(),
            [](const auto& a, const auto& b) { return key(a) < key(b); });
}

}  // namespace dapple
