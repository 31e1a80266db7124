// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/types.hpp>
#include <span>
#include <utility>
#include <vector>

namespace dapple {

/// Lists of points by the hash of their cell, all in two arrays, because a map of vectors is slow
/// to grow and to free.
class Buckets {
 public:
  explicit Buckets(std::size_t points) : slots_(kFewest), next_(points, -1) {}

  /// The first point of a list, -1 for none; next() gives the others, in the order they came.
  [[nodiscard]] std::int32_t first(std::uint64_t key) const { return slots_[find(key)].first; }
  [[nodiscard]] std::int32_t next(std::int32_t k) const {
    return next_[static_cast<std::size_t>(k)];
  }

  void add(std::uint64_t key, std::int32_t k) {
    Slot& slot = slots_[find(key)];
    if (slot.first < 0) {
      slot = {key, k, k};
      if (2 * ++used_ > slots_.size()) grow();
      return;
    }
    next_[static_cast<std::size_t>(slot.last)] = k;
    slot.last = k;
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int32_t first = -1, last = -1;
  };
  static constexpr std::size_t kFewest = 1024;  // a power of two, as all sizes are

  /// The slot of the key, or else the free slot for it.
  [[nodiscard]] std::size_t find(std::uint64_t key) const {
    std::size_t at = ((key ^ (key >> 32)) * 0x9e3779b97f4a7c15u >> 32) & (slots_.size() - 1);
    while (slots_[at].first >= 0 && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }

  void grow() {
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(2 * slots_.size()));
    for (const Slot& slot : old)
      if (slot.first >= 0) slots_[find(slot.key)] = slot;
  }

  std::vector<Slot> slots_;
  std::vector<std::int32_t> next_;  // per point, in its list
  std::size_t used_ = 0;
};

/// Finds, for points added one after another, an earlier one within the tolerance.
class Places {
 public:
  /// \pre there is a point
  Places(std::span<const Vec3> points, double tolerance)
      : points_(points), tolerance_(tolerance), low_(points[0]), cells_(points.size()) {
    Vec3 high = low_;
    for (const Vec3& p : points) {
      low_ = low_.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    cell_ = std::max({kCell * tolerance, kFinest * (high - low_).maxCoeff(), 1e-300});
  }

  /// The first point added within the tolerance of this one; -1 if there is none.
  [[nodiscard]] std::int32_t find(const Vec3& p) const {
    const Address from = address(p - Vec3::Constant(tolerance_));
    const Address to = address(p + Vec3::Constant(tolerance_));
    std::int32_t best = -1;
    for (std::int64_t x = from[0]; x <= to[0]; ++x)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t z = from[2]; z <= to[2]; ++z) best = lower(best, find_in({x, y, z}, p));
    return best;
  }

  void add(std::int32_t k) { cells_.add(hash(address(points_[static_cast<std::size_t>(k)])), k); }

 private:
  static constexpr double kCell = 64.0;    // side, in tolerances: few points are near a side
  static constexpr double kFinest = 1e-9;  // of the extent: side where the tolerance is 0

  using Address = std::array<std::int64_t, 3>;

  static std::int32_t lower(std::int32_t a, std::int32_t b) {
    return a < 0 || (b >= 0 && b < a) ? b : a;
  }

  [[nodiscard]] std::int32_t find_in(const Address& at, const Vec3& p) const {
    std::int32_t k = cells_.first(hash(at));
    while (k >= 0 && !((points_[static_cast<std::size_t>(k)] - p).norm() <= tolerance_))
      k = cells_.next(k);
    return k;
  }

  [[nodiscard]] Address address(const Vec3& p) const {
    const auto along = [&](Eigen::Index k) {
      return static_cast<std::int64_t>(std::floor((p[k] - low_[k]) / cell_));
    };
    return {along(0), along(1), along(2)};
  }

  static std::uint64_t hash(const Address& a) {
    return static_cast<std::uint64_t>(a[0]) * 0x9e3779b97f4a7c15u ^
           static_cast<std::uint64_t>(a[1]) * 0xc2b2ae3d27d4eb4fu ^
           static_cast<std::uint64_t>(a[2]) * 0x165667b19e3779f9u;
  }

  std::span<const Vec3> points_;
  double tolerance_;
  Vec3 low_;
  double cell_;
  Buckets cells_;
};

}  // namespace dapple
