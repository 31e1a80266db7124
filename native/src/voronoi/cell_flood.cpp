// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_flood.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

// Number of floods before the stamps restart at 0; the indices of sites have about the same limit.
constexpr std::int32_t kMostStamps = 1 << 30;
// Rounding error of x . (x_j - x_i), relative to r |x_j - x_i|, where r is the radius of a polygon.
constexpr double kTie = 1e-14;
constexpr std::size_t kMostTies = 8;  // number of equally near sites that are tried

Vec3 vector(const Triple& x) { return {x.x, x.y, x.z}; }

}  // namespace

CellFlood::CellFlood(const Surface& surface, const OrderedSites& sites, const SiteIndex& index,
                     const OrderedLinks* links)
    : surface_(&surface),
      sites_(&sites),
      bisectors_(surface, sites, index, links),
      stamps_(surface.face_count(), 0) {}

void CellFlood::restart(const DensitySupport* support) {
  support_ = support;
  bisectors_.restart();
  if (stamp_ < kMostStamps && turn_ < kMostStamps) return;
  std::fill(stamps_.begin(), stamps_.end(), 0);
  std::fill(own_vertices_.begin(), own_vertices_.end(), 0);
  stamp_ = turn_ = 0;
}

bool CellFlood::reset(std::int32_t site, Rivals rivals) {
  turn_to(site);
  bisectors_.reset(site, rivals);
  owner_ = bisectors_.owner();
  bounded_ = support_ && support_->has(sites_->faces[as_index(site)]);
  return owner_ == site_;
}

bool CellFlood::reset_far(std::int32_t site) {
  turn_to(site);
  bisectors_.reset_far(site);
  owner_ = bisectors_.owner();
  return owner_ == site_;
}

void CellFlood::turn_to(std::int32_t site) {
  site_ = owner_ = site;
  ++turn_;
}

void CellFlood::reset_among(std::int32_t site, std::span<const std::int32_t> others) {
  turn_to(site);
  bisectors_.reset_among(site, others);
}

bool CellFlood::clip(OrderedFace face) {
  cuts_.clear();
  whole_ = true;
  const auto [a, b, c] = surface_->ordered().corners(face);
  const Triple x(position());
  const HalfSpaces::Triangle triangle = {Triple(surface_->ordered().vertex(a)) - x,
                                         Triple(surface_->ordered().vertex(b)) - x,
                                         Triple(surface_->ordered().vertex(c)) - x};
  polygon_.start(triangle[0], triangle[1], triangle[2]);
  if (!clip_near(triangle)) clip_far(triangle, {a, b, c});
  bisectors_.note_need(4.0 * polygon_.squared_radius());
  return whole_;
}

/// Returns false if other sites may cut the polygon too.
bool CellFlood::clip_near(const HalfSpaces::Triangle& triangle) {
  // Only sites with |x_j - x_i| <= 2 r can cut the polygon.
  const double floor = -2.0 * kTie * polygon_.squared_radius();
  std::size_t k = 0;
  while (const Bisector* next = bisectors_.at(k)) {
    if (is_far(*next)) return true;
    const std::size_t last =
        std::min(k - k % HalfSpaces::kBlock + HalfSpaces::kBlock, bisectors_.settled());
    const unsigned skipped = k % HalfSpaces::kBlock;
    // A half-space that does not reach the triangle does not reach the rest of it.
    const unsigned reached = bisectors_.half_spaces().reached_by(k - skipped, triangle, floor);
    if (!cut_by_those(reached >> skipped, k, last) || is_far(*bisectors_.at(last - 1))) return true;
    k = last;
  }
  return bisectors_.complete();
}

/// If a cell reaches far beyond the site's neighbors, for example because few sites own a large
/// area, the distance from the site does not determine the relevant sites. Then the corners of the
/// rest of the face are tested: the rest is convex, so it belongs to the site if all corners do.
void CellFlood::clip_far(const HalfSpaces::Triangle& triangle,
                         const std::array<std::int32_t, 3>& vertices) {
  rest_.start(polygon_.corners());
  far_.clear();
  take_known_far();
  find_far(triangle, vertices);
  std::sort(far_.begin(), far_.end(), [this](std::int32_t a, std::int32_t b) {
    const Bisector &one = bisector(a), &other = bisector(b);
    return one.squared_distance != other.squared_distance
               ? one.squared_distance < other.squared_distance
               : sites_->original(one.site) < sites_->original(other.site);
  });
  for (const std::int32_t k : far_)
    if (!cut_by(bisector(k), static_cast<std::size_t>(k)) || polygon_.empty()) return;
}

/// Bisectors that have cut one face are likely to cut the next one.
void CellFlood::take_known_far() {
  for (std::size_t k = bisectors_.first_far(); k < bisectors_.end() && !rest_.empty(); ++k) {
    const Bisector& known = bisectors_.known(k);
    if (rest_.measure(known.normal, known.offset).high > 0.0) (void)take_far(k);
  }
}

/// If another site is nearer to a corner, its bisector cuts the corner off.
void CellFlood::find_far(const HalfSpaces::Triangle& triangle,
                         const std::array<std::int32_t, 3>& vertices) {
  own_vertices_.resize(surface_->vertex_count(), 0);
  sure_.clear();
  for (std::size_t k = 0; k < 3; ++k)
    if (own_vertices_[static_cast<std::size_t>(vertices[k])] == turn_)
      sure_.push_back(vector(triangle[k]));
  std::size_t idle = 0;
  while (const Vec3* corner = next_unsure()) {
    const std::size_t k = bisectors_.nearest_to(*corner, far_);
    if (k != Bisectors::kNone && (take_far(k) || ++idle < kMostTies)) continue;
    if (k == Bisectors::kNone && idle == 0)  // ties may also concern adjacent faces
      for (std::size_t v = 0; v < 3; ++v)
        if (*corner == vector(triangle[v]))
          own_vertices_[static_cast<std::size_t>(vertices[v])] = turn_;
    sure_.push_back(*corner);
  }
}

/// Whether the bisector cuts anything off.
bool CellFlood::take_far(std::size_t k) {
  const Bisector& bisector = bisectors_.known(k);
  far_.push_back(static_cast<std::int32_t>(k));
  if (rest_.measure(bisector.normal, bisector.offset).high <= 0.0) return false;
  rest_.cut(static_cast<std::int32_t>(k));
  return true;
}

/// A corner of the remaining polygon that may belong to another site.
const Vec3* CellFlood::next_unsure() const {
  for (const Polygon::Corner& corner : rest_.corners())
    if (std::find(sure_.begin(), sure_.end(), corner.x) == sure_.end()) return &corner.x;
  return nullptr;
}

/// Cut by the bisectors in [first, last) whose bits are set. Returns false if nothing is left.
bool CellFlood::cut_by_those(unsigned reached, std::size_t first, std::size_t last) {
  for (; reached != 0; reached &= reached - 1) {
    const std::size_t k = first + static_cast<std::size_t>(std::countr_zero(reached));
    if (k >= last) return true;
    const Bisector& bisector = *bisectors_.at(k);
    if (is_far(bisector)) return false;
    if (bisector.idle || bisector.squared_distance == 0.0) continue;
    if (!cut_by(bisector, k)) return false;
  }
  return true;
}

bool CellFlood::cut_by(const Bisector& bisector, std::size_t k) {
  const auto [low, high] = polygon_.measure(bisector.normal, bisector.offset);
  const double tie = kTie * std::sqrt(polygon_.squared_radius() * bisector.squared_distance);
  if (low >= -tie && high <= tie) {
    if (sites_->original(site_) < sites_->original(bisector.site)) return true;
    cuts_.push_back(static_cast<std::int32_t>(k));
    polygon_.clear();
    whole_ = false;
    return false;
  }
  if (high <= 0.0) return true;
  polygon_.cut(static_cast<std::int32_t>(k));
  cuts_.push_back(static_cast<std::int32_t>(k));
  whole_ = false;
  return true;
}

}  // namespace dapple
