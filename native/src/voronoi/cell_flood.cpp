// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_flood.hpp"

namespace dapple {
namespace {

constexpr double kTie = 1e-14;  // of a polygon's squared radius: rounding of x . (x_j - x_i)

}  // namespace

CellFlood::CellFlood(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface),
      sites_(&sites),
      bisectors_(surface, sites, index),
      stamps_(surface.face_count(), 0) {}

bool CellFlood::reset(std::int32_t site) {
  site_ = site;
  bisectors_.reset(site);
  owner_ = bisectors_.owner();
  return owner_ == site_;
}

void CellFlood::reset_among(std::int32_t site, std::span<const std::int32_t> others) {
  site_ = owner_ = site;
  bisectors_.reset_among(site, others);
}

bool CellFlood::clip(OrderedFace face) {
  tied_to_ = -1;
  const auto [a, b, c] = surface_->ordered().corners(face);
  const Vec3& x = position();
  polygon_.start(surface_->ordered().vertex(a) - x, surface_->ordered().vertex(b) - x,
                 surface_->ordered().vertex(c) - x);
  double radius = polygon_.squared_radius();
  bool whole = true;
  std::size_t k = 0;
  for (const Bisector* b_k = bisectors_.at(0); b_k && b_k->squared_distance < 4.0 * radius;
       b_k = bisectors_.at(++k)) {
    if (b_k->idle || b_k->squared_distance == 0.0) continue;
    const auto [low, high] = polygon_.measure(b_k->normal, b_k->offset);
    if (low >= -kTie * radius && high <= kTie * radius) {
      if (sites_->original(site_) < sites_->original(b_k->site)) continue;
      tied_to_ = b_k->site;
      polygon_.clear();
      return false;
    }
    if (high <= 0.0) continue;
    polygon_.cut(static_cast<std::int32_t>(k));
    whole = false;
    radius = polygon_.squared_radius();
  }
  return whole;
}

}  // namespace dapple
