// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/darts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/allot.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kCells = 0x1p62;  // numbers of cells along an axis

/// What is left of the quotas once some are taken; where a component holds more than its quota, the
/// others give up places, the richest first.
void subtract(std::vector<std::size_t>& quotas, const std::vector<std::size_t>& taken) {
  std::size_t owed = 0;
  for (std::size_t k = 0; k < quotas.size(); ++k) {
    const std::size_t given = std::min(quotas[k], taken[k]);
    quotas[k] -= given;
    owed += taken[k] - given;
  }
  for (; owed > 0; --owed) {
    const auto richest = std::max_element(quotas.begin(), quotas.end());
    if (*richest > 0) --*richest;
  }
}

}  // namespace

Dart dart_at(const Surface& surface, OrderedFace face, const Vec3& weights) {
  const OrderedSurface& ordered = surface.ordered();
  return {surface.point(ordered.original_face(face), weights),
          weights,
          ordered.geometry(face).normal,
          face,
          ordered.component(face),
          weights.dot(ordered.densities(face))};
}

// ---- DartBoard ----

DartBoard::DartBoard(const Surface& surface, std::size_t count, const std::vector<Dart>& taken)
    : surface_(&surface), masses_(static_cast<std::size_t>(surface.ordered().components()), 0.0) {
  for (std::size_t f = 0; f < surface.face_count(); ++f)
    masses_[component(nth_face(f))] += surface.ordered().geometry(nth_face(f)).moments.capacity;
  // Once cells follow the surface, components exchange no sites.
  places_ = allot(masses_, count);
  std::vector<std::size_t> held(places_.size(), 0);
  for (const Dart& dart : taken) ++held[component(dart.face)];
  subtract(places_, held);
  sum_up();
}

Dart DartBoard::draw(Random& random) const {
  while (true) {
    const double target = random.uniform() * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), target);
    const auto k =
        static_cast<std::size_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
    if (places_[component(nth_face(k))] > 0) return draw_on(nth_face(k), random);
  }
}

void DartBoard::take(const Dart& dart) {
  const std::size_t c = component(dart.face);
  if (--places_[c] > 0) return;
  closed_ += masses_[c];
  if (closed_ > 0.5 * cumulative_.back()) sum_up();
}

std::size_t DartBoard::component(OrderedFace face) const {
  return static_cast<std::size_t>(surface_->ordered().component(face));
}

void DartBoard::sum_up() {
  double sum = 0.0;
  closed_ = 0.0;
  cumulative_.resize(surface_->face_count());
  for (std::size_t f = 0; f < cumulative_.size(); ++f) {
    if (places_[component(nth_face(f))] > 0)
      sum += surface_->ordered().geometry(nth_face(f)).moments.capacity;
    cumulative_[f] = sum;
  }
}

// Uniform on the face, then accepted in proportion to the density: at least a third is, since it is
// linear.
Dart DartBoard::draw_on(OrderedFace face, Random& random) const {
  const Vec3 values = surface_->ordered().densities(face);
  while (true) {
    const double root = std::sqrt(random.uniform());
    const double along = random.uniform();
    const Vec3 weights(1.0 - root, root * (1.0 - along), root * along);
    if (random.uniform() * values.maxCoeff() >= weights.dot(values)) continue;
    return dart_at(*surface_, face, weights);
  }
}

// ---- DartGrid ----

DartGrid::DartGrid(double cell, double period)
    : cell_(cell), period_(period), side_(1), heads_(16, kNone) {
  if (!flat()) return;
  side_ = static_cast<std::int64_t>(std::clamp(period / cell, 1.0, 1e6));
  cell_ = period / static_cast<double>(side_);
}

void DartGrid::insert(const Dart& dart, double radius) {
  members_.push_back({dart, radius, kNone});
  if (members_.size() > heads_.size())
    grow();
  else
    link(members_.size() - 1);
}

Vec3 DartGrid::offset(const Vec3& from, const Vec3& to) const {
  Vec3 d = to - from;
  if (flat())
    for (Eigen::Index k = 0; k < 2; ++k) d[k] -= period_ * std::round(d[k] / period_);
  return d;
}

DartGrid::Address DartGrid::address(const Vec3& p) const {
  // Far out the numbers of cells begin anew: two may be one, as they may in a bucket.
  const auto along = [&](double x) {
    const double cell = std::fmod(std::floor(x / cell_), kCells);
    return std::isfinite(cell) ? static_cast<std::int64_t>(cell) : 0;
  };
  return {along(p.x()), along(p.y()), along(p.z())};
}

std::size_t DartGrid::bucket(Address a) const {
  if (flat())
    for (std::size_t k = 0; k < 2; ++k) a[k] = ((a[k] % side_) + side_) % side_;
  const auto part = [](std::int64_t x, std::uint64_t prime) {
    return static_cast<std::uint64_t>(x) * prime;
  };
  const std::uint64_t hash = part(a[0], 0x9e3779b97f4a7c15u) ^ part(a[1], 0xc2b2ae3d27d4eb4fu) ^
                             part(a[2], 0x165667b19e3779f9u);
  return (hash >> 32) & (heads_.size() - 1);
}

void DartGrid::link(std::size_t member) {
  std::size_t& head = heads_[bucket(address(members_[member].dart.position))];
  members_[member].next = head;
  head = member;
}

void DartGrid::grow() {
  heads_.assign(4 * heads_.size(), kNone);
  for (std::size_t m = 0; m < members_.size(); ++m) link(m);
}

// ---- DartSet ----

bool DartSet::refuses(const Dart& dart, double radius) const {
  const auto reach = [&](const Dart& other, double other_radius) {
    return dart.sees(other) ? std::min(radius, other_radius) : 0.0;
  };
  return std::any_of(grids_.begin(), grids_.end(),
                     [&](const auto& entry) { return entry.second.refuses(dart, reach); });
}

void DartSet::insert(const Dart& dart, double radius) {
  entries_.push_back({dart, radius});
  place(entries_.back());
}

void DartSet::scale(double factor) {
  grids_.clear();
  for (Entry& entry : entries_) {
    entry.radius *= factor;
    place(entry);
  }
}

void DartSet::place(const Entry& entry) {
  const int octave = std::ilogb(entry.radius) + 1;
  grids_.try_emplace(octave, std::ldexp(1.0, octave), period_)
      .first->second.insert(entry.dart, entry.radius);
}

}  // namespace dapple
