// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/dart_grid.hpp"

#include <algorithm>

namespace dapple {
namespace {

constexpr double kCells = 0x1p62;   // most cells along an axis
constexpr double kSlack = 0x1p-50;  // of a position in cells: larger than its rounding error

}  // namespace

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

void DartGrid::clear() {
  members_.clear();
  std::fill(heads_.begin(), heads_.end(), kNone);
}

void DartGrid::begin_around(std::vector<Walk>& walks, std::size_t dart, const Dart& thrown,
                            double most) const {
  const Block block = around(thrown.position, most);
  for (std::int64_t x = block.low[0]; x <= block.high[0]; ++x)
    for (std::int64_t y = block.low[1]; y <= block.high[1]; ++y)
      for (std::int64_t z = block.low[2]; z <= block.high[2]; ++z)
        if (Address{x, y, z} != block.center) begin(walks, dart, bucket({x, y, z}));
}

void DartGrid::enter_buckets(std::vector<Walk>& walks) const {
  std::size_t left = 0;
  for (const Walk& walk : walks)
    if (heads_[walk.at] != kNone) go_on(walks, left, {walk.dart, heads_[walk.at]});
  walks.resize(left);
}

// Far from the origin the numbers of cells wrap around, so that two cells may have the same number;
// this is harmless, as in a hash table.
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

}  // namespace dapple
