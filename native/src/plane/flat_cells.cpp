// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/flat_cells.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/hexagonal.hpp"

namespace dapple {
namespace {

// Cells with more near sites than this are unusual; for them, the sites nearest to the corners are
// searched.
constexpr std::size_t kMany = NearSites<FlatSites>::kMost - 1;
constexpr std::int32_t kFrame = -1;  // label of the edges along the frame

auto key(const SiteGraph::Link& link) {
  return std::tuple(link.offset.squaredNorm(), link.site, link.offset.x(), link.offset.y());
}

}  // namespace

FlatCells::FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame)
    : FlatCells(sites, frame, frame.volume()) {}

FlatCells::FlatCells(const FlatSites& sites) : FlatCells(sites, Eigen::AlignedBox2d(), 1.0) {}

FlatCells::FlatCells(const FlatSites& sites, const Eigen::AlignedBox2d& frame, double area)
    : sites_(&sites),
      frame_(frame),
      near_(sites, hexagonal_spacing(area / static_cast<double>(sites.size()))) {}

void FlatCells::turn_to(std::int32_t place) {
  place_ = place;
  begin();
  near_.turn_to(place_);
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
  cutting_.clear();
  if (!sites_->periodic()) {
    const Vec2 x = sites_->position(place_).head<2>();
    const Vec2 low = frame_.min() - x, high = frame_.max() - x;
    cell_.corners = {{low, kFrame},
                     {{high.x(), low.y()}, kFrame},
                     {high, kFrame},
                     {{low.x(), high.y()}, kFrame}};
    return;
  }
  for (const Vec2& way : {Vec2(0, -1), Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0)})
    cutting_.push_back({sites_->site(place_), Vec3(way.x(), way.y(), 0.0)});
  cell_.corners = {{{-0.5, -0.5}, 0}, {{0.5, -0.5}, 1}, {{0.5, 0.5}, 2}, {{-0.5, 0.5}, 3}};
}

/// Returns false if sites that were not found here might cut the cell.
bool FlatCells::cut_by_near() {
  double needed = 4.0 * cell_.squared_radius();
  for (std::size_t next = 0;; near_.extend()) {
    const std::span<const Rival> near = near_.all();
    for (; next < std::min(kMany, near.size()); ++next) {
      if (near[next].squared_distance > needed) break;
      if (cut(near[next].site)) needed = 4.0 * cell_.squared_radius();
    }
    const bool many = near.size() > kMany;
    const double known = many ? near[kMany].squared_distance : near_.squared_reach();
    near_.note_need(std::min(needed, known));
    if (needed < known || !std::isfinite(known)) return true;
    if (many) return false;
  }
}

// A convex polygon belongs to the site if all its corners do. If another site is nearer to a
// corner, its bisector cuts the corner off. A site cuts twice only because of rounding.
void FlatCells::cut_by_nearest_to_corners() {
  for (std::size_t c = 0; c < cell_.corners.size();) {
    const std::int32_t nearest = nearest_to(cell_.corners[c].x);
    const SiteGraph::Link link = link_to(nearest);
    const bool known =
        nearest == place_ || std::any_of(cutting_.begin(), cutting_.end(), [&](const auto& other) {
          return other.site == link.site && other.offset == link.offset;
        });
    c = !known && cut(nearest) ? 0 : c + 1;
  }
}

/// The image nearest to a corner; the site itself if no other one is nearer.
std::int32_t FlatCells::nearest_to(const Vec2& corner) const {
  const Vec3 x = sites_->position(place_);
  std::int32_t best = place_;
  double least = corner.squaredNorm();
  sites_->for_each_nearest(x + Vec3(corner.x(), corner.y(), 0.0), least, [&](std::int32_t image) {
    const double squared = ((sites_->position(image) - x).head<2>() - corner).squaredNorm();
    if (!(squared < least) || sites_->site(image) == sites_->site(place_)) return;
    least = squared;
    best = image;
  });
  return best;
}

/// Whether the bisector with an image cuts anything off. The site's own images have cut already.
bool FlatCells::cut(std::int32_t image) {
  const SiteGraph::Link link = link_to(image);
  if (link.site == sites_->site(place_) ||
      !cell_.cut(link.offset.head<2>(), 0.5 * link.offset.squaredNorm(),
                 static_cast<std::int32_t>(cutting_.size())))
    return false;
  cutting_.push_back(link);
  return true;
}

SiteGraph::Link FlatCells::link_to(std::int32_t image) const {
  return {sites_->site(image), sites_->position(image) - sites_->position(place_)};
}

/// Collect the sites that bound the cell. If nothing of it is left because of rounding, collect all
/// sites that have cut it.
void FlatCells::collect_links() {
  links_.clear();
  if (cell_.corners.empty()) links_ = cutting_;
  for (const FlatPolygon::Corner& corner : cell_.corners)
    if (corner.edge != kFrame) links_.push_back(cutting_[static_cast<std::size_t>(corner.edge)]);
  std::sort(links_.begin(), links_.end(),
            [](const auto& a, const auto& b) { return key(a) < key(b); });
}

}  // namespace dapple
