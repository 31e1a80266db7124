// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "base/prefetch.hpp"
#include "start/dart.hpp"

namespace dapple {

/// Darts in a hashed grid over space, or around the torus [0, period)^2.
class DartGrid {
 public:
  /// A member that others keep away from; it fills a cache line.
  struct alignas(64) Member {
    Vec3 position;
    Vec3 normal;
    double radius;
    std::int32_t component;
    std::uint32_t next;  // in the same bucket
  };

  /// \param cell   not smaller than any distance asked for
  /// \param period 0 for unbounded space
  DartGrid(double cell, double period);

  void insert(const Dart& dart, double radius);
  /// Remove all members and keep their memory.
  void clear();

  /// Whether a member lies nearer to the dart than `reach(member)`, which is at most `most`.
  template <typename Reach>
  [[nodiscard]] bool refuses(const Dart& dart, double most, const Reach& reach) const {
    const Block block = around(dart.position, most);
    // Its own cell is most likely to refuse it.
    if (refuses_in(bucket(block.center), dart, reach)) return true;
    for (std::int64_t x = block.low[0]; x <= block.high[0]; ++x)
      for (std::int64_t y = block.low[1]; y <= block.high[1]; ++y)
        for (std::int64_t z = block.low[2]; z <= block.high[2]; ++z)
          if (Address{x, y, z} != block.center && refuses_in(bucket({x, y, z}), dart, reach))
            return true;
    return false;
  }

  /// A candidate that members may refuse.
  struct Asked {
    const Dart* dart;
    double most;
    bool refused = false;
  };

  /// The same for many darts, `reach(asked, member)`. All take steps together, so that memory for
  /// the next step loads meanwhile; one at a time they would mostly wait for memory.
  template <typename Reach>
  void refuse(std::span<Asked> asked, const Reach& reach) const {
    std::vector<Walk> walks;
    walks.reserve(asked.size());
    for (std::size_t k = 0; k < asked.size(); ++k)
      if (!asked[k].refused) begin(walks, k, bucket(address(asked[k].dart->position)));
    finish(walks, asked, reach);
    for (std::size_t k = 0; k < asked.size(); ++k)
      if (!asked[k].refused) begin_around(walks, k, *asked[k].dart, asked[k].most);
    finish(walks, asked, reach);
  }

 private:
  using Address = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  /// The cells that a ball touches: one or two along each axis, three where rounding may hide it.
  struct Block {
    Address center, low, high;
  };

  // Cells may share a bucket: that costs distance tests, but results stay correct.
  template <typename Reach>
  bool refuses_in(std::size_t bucket, const Dart& dart, const Reach& reach) const {
    for (std::uint32_t m = heads_[bucket]; m != kNone; m = members_[m].next) {
      const double distance = reach(members_[m]);
      if (offset(members_[m].position, dart.position).squaredNorm() < distance * distance)
        return true;
    }
    return false;
  }

  /// Along the members of a bucket, for one of the darts that are asked about.
  struct Walk {
    std::uint32_t dart;
    std::uint32_t at;  // a bucket, then a member
  };

  void begin(std::vector<Walk>& walks, std::size_t dart, std::size_t bucket) const {
    prefetch(&heads_[bucket]);
    walks.push_back({static_cast<std::uint32_t>(dart), static_cast<std::uint32_t>(bucket)});
  }
  void begin_around(std::vector<Walk>& walks, std::size_t dart, const Dart& thrown,
                    double most) const;
  void enter_buckets(std::vector<Walk>& walks) const;

  template <typename Reach>
  void finish(std::vector<Walk>& walks, std::span<Asked> asked, const Reach& reach) const {
    enter_buckets(walks);
    while (!walks.empty()) {
      std::size_t left = 0;
      for (const Walk& walk : walks) {
        Asked& dart = asked[walk.dart];
        if (dart.refused) continue;
        const Member& member = members_[walk.at];
        const double distance = reach(dart, member);
        dart.refused =
            offset(member.position, dart.dart->position).squaredNorm() < distance * distance;
        if (!dart.refused && member.next != kNone) go_on(walks, left, {walk.dart, member.next});
      }
      walks.resize(left);
    }
  }

  void go_on(std::vector<Walk>& walks, std::size_t& left, const Walk& walk) const {
    prefetch(&members_[walk.at]);
    walks[left++] = walk;
  }

  [[nodiscard]] bool flat() const { return period_ > 0.0; }
  [[nodiscard]] Vec3 offset(const Vec3& from, const Vec3& to) const {
    Vec3 d = to - from;
    if (flat())
      for (Eigen::Index k = 0; k < 2; ++k) d[k] -= period_ * std::round(d[k] / period_);
    return d;
  }
  [[nodiscard]] Block around(const Vec3& p, double most) const;
  [[nodiscard]] Address address(const Vec3& p) const;
  [[nodiscard]] std::size_t bucket(Address a) const;
  void link(std::uint32_t member);
  void grow();

  double cell_;
  double period_;
  std::int64_t side_;                 // cells around the torus
  std::vector<std::uint32_t> heads_;  // per bucket; a power of two
  std::vector<Member> members_;
};

}  // namespace dapple
