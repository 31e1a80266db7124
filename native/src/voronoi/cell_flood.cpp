// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_flood.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/triangle.hpp"

namespace dapple {
namespace {

// Floods before their stamps begin anew: with more sites than that, indices end too.
constexpr std::int32_t kMostStamps = 1 << 30;
// Rounding of x . (x_j - x_i), of r |x_j - x_i| with r the radius of a polygon.
constexpr double kTie = 1e-14;
constexpr double kOverGaps = 0.8;  // spacings from a site: farther gaps matter to nobody

}  // namespace

CellFlood::CellFlood(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface),
      sites_(&sites),
      bisectors_(surface, sites, index),
      stamps_(surface.face_count(), 0) {}

void CellFlood::restart(bool gaps) {
  gaps_ = gaps;
  bisectors_.restart();
  if (stamp_ < kMostStamps) return;
  std::fill(stamps_.begin(), stamps_.end(), 0);
  stamp_ = 0;
}

bool CellFlood::reset(std::int32_t site, Rivals rivals) {
  site_ = site;
  bisectors_.reset(site, rivals);
  owner_ = bisectors_.owner();
  if (gaps_) squared_gap_reach_ = std::pow(gap_reach(), 2);
  return owner_ == site_;
}

/// Where neighbors repel each other over a gap, in spacings of the density at the site. A site that
/// has none itself is to see how far it is to where there is some.
double CellFlood::gap_reach() const {
  const OrderedSurface& mesh = surface_->ordered();
  const Moments& own = mesh.geometry(sites_->faces[static_cast<std::size_t>(site_)]).moments;
  if (!(own.capacity > 0.0)) return std::numeric_limits<double>::infinity();
  return kOverGaps * surface_->spacing(sites_->size()) *
         std::sqrt(mesh.unit_mass() / mesh.area() * own.area / own.capacity);
}

bool CellFlood::is_far_gap(OrderedFace face) const {
  const OrderedSurface& mesh = surface_->ordered();
  if (mesh.geometry(face).moments.capacity > 0.0) return false;
  const auto [a, b, c] = mesh.corners(face);
  const Vec3 nearest = mesh.point(
      face, closest_barycentric(position(), mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)));
  return (nearest - position()).squaredNorm() > squared_gap_reach_;
}

void CellFlood::reset_among(std::int32_t site, std::span<const std::int32_t> others) {
  site_ = owner_ = site;
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
  // No |x_j - x_i| that counts is above 2 r.
  const double floor = -2.0 * kTie * polygon_.squared_radius();
  std::size_t k = 0;
  while (const Bisector* next = bisectors_.at(k)) {
    if (is_far(*next)) break;
    const std::size_t last =
        std::min(k - k % HalfSpaces::kBlock + HalfSpaces::kBlock, bisectors_.settled());
    const unsigned skipped = k % HalfSpaces::kBlock;
    // What does not reach the triangle does not reach what is left of it.
    const unsigned reached = bisectors_.half_spaces().reached_by(k - skipped, triangle, floor);
    if (!cut_by_those(reached >> skipped, k, last) || is_far(*bisectors_.at(last - 1))) break;
    k = last;
  }
  bisectors_.note_need(4.0 * polygon_.squared_radius());
  return whole_;
}

/// Of the bisectors in [first, last) those whose bits are set. False if nothing is left to cut.
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
