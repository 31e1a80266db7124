// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/darts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/allot.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kCells = 0x1p62;   // numbers of cells along an axis
constexpr double kSlack = 0x1p-50;  // of a place in cells: more than it is rounded by

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
  return {ordered.point(face, weights),  weights,
          ordered.geometry(face).normal, face,
          ordered.component(face),       weights.dot(ordered.densities(face))};
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

DartBoard::Draw DartBoard::draw(Random& random) const {
  while (true) {
    const OrderedFace face = nth_face(face_at(random.uniform() * cumulative_.back()));
    if (places_[component(face)] > 0) return draw_on(face, random);
  }
}

// The first face whose cumulative mass lies above: a binary search would miss the cache at each of
// its steps.
std::size_t DartBoard::face_at(double mass) const {
  const std::size_t last = cumulative_.size() - 1;
  const double part = mass / cumulative_.back() * static_cast<double>(guide_.size());
  std::size_t k = guide_[std::min(static_cast<std::size_t>(part), guide_.size() - 1)];
  while (k > 0 && cumulative_[k - 1] > mass) --k;  // rounding
  while (k < last && cumulative_[k] <= mass) ++k;
  return k;
}

bool DartBoard::take(const Dart& dart) {
  const std::size_t c = component(dart.face);
  if (--places_[c] > 0) return false;
  closed_ += masses_[c];
  if (closed_ > 0.5 * cumulative_.back()) sum_up();
  return true;
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
  guide_.resize(cumulative_.size());
  std::size_t k = 0;
  for (std::size_t part = 0; part < guide_.size(); ++part) {
    const double begin = sum * static_cast<double>(part) / static_cast<double>(guide_.size());
    while (k + 1 < cumulative_.size() && cumulative_[k] <= begin) ++k;
    guide_[part] = static_cast<std::uint32_t>(k);
  }
}

// Uniform on the face, then accepted in proportion to the density: at least a third is, since it is
// linear.
DartBoard::Draw DartBoard::draw_on(OrderedFace face, Random& random) const {
  const Vec3 values = surface_->ordered().densities(face);
  while (true) {
    const double root = std::sqrt(random.uniform());
    const double along = random.uniform();
    const Vec3 weights(1.0 - root, root * (1.0 - along), root * along);
    if (random.uniform() * values.maxCoeff() >= weights.dot(values)) continue;
    return {face, weights};
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
  members_.push_back({dart.position, dart.normal, radius, dart.component, kNone});
  if (members_.size() > heads_.size())
    grow();
  else
    link(static_cast<std::uint32_t>(members_.size() - 1));
}

// Far out the numbers of cells begin anew: two may be one, as they may in a bucket.
DartGrid::Address DartGrid::address(const Vec3& p) const {
  const auto along = [&](double x) {
    double cell = std::floor(x / cell_);
    if (!(std::abs(cell) < kCells)) cell = std::fmod(cell, kCells);
    return std::isfinite(cell) ? static_cast<std::int64_t>(cell) : 0;
  };
  return {along(p.x()), along(p.y()), along(p.z())};
}

DartGrid::Block DartGrid::around(const Vec3& p, double most) const {
  const Address center = address(p);
  Block block{center, center, center};
  for (Eigen::Index k = 0; k < (flat() ? 2 : 3); ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double at = p[k] / cell_;
    const double inside = at - std::floor(at);
    const double reach = most / cell_ * (1.0 + kSlack) + kSlack * (1.0 + std::abs(at));
    if (!(inside > reach)) --block.low[axis];
    if (!(1.0 - inside > reach)) ++block.high[axis];
  }
  return block;
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

void DartGrid::link(std::uint32_t member) {
  std::uint32_t& head = heads_[bucket(address(members_[member].position))];
  members_[member].next = head;
  head = member;
}

void DartGrid::grow() {
  heads_.assign(4 * heads_.size(), kNone);
  for (std::uint32_t m = 0; m < members_.size(); ++m) link(m);
}

// ---- DartSet ----

bool DartSet::refuses(const Dart& dart, double radius) const {
  const auto reach = [&](const DartGrid::Member& other) {
    return see_each_other(dart, other) ? std::min(radius, other.radius) : 0.0;
  };
  return std::any_of(grids_.begin(), grids_.end(), [&](const auto& entry) {
    const double most = std::min(radius, std::ldexp(1.0, entry.first));
    return entry.second.refuses(dart, most, reach);
  });
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
