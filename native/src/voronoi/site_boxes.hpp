// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <dapple/types.hpp>
#include <span>
#include <vector>

#include "voronoi/eight_boxes.hpp"

namespace dapple {

/// Bounding boxes over points sorted along a space-filling curve: eight points per leaf, eight
/// boxes per box. Without links, so that building takes one pass.
class SiteBoxes {
 public:
  static constexpr std::size_t kFan = 8;

  /// Empty.
  SiteBoxes() = default;

  /// \param points must outlive the boxes
  explicit SiteBoxes(std::span<const Vec3> points) { assign(points); }

  /// Rebuild for other points, in the same memory.
  void assign(std::span<const Vec3> points);

  [[nodiscard]] Box leaf_of(std::size_t point) const { return box(0, point / kFan); }

  /// A box around a few points that are near each other. The same box, the same number.
  struct Neighborhood {
    std::size_t number;
    Box box;
  };
  /// The one that a point is in.
  [[nodiscard]] Neighborhood neighborhood(std::size_t point) const {
    return {point / kFan, leaf_of(point)};
  }
  /// Eight neighborhoods that follow each other.
  [[nodiscard]] Neighborhood block(const Neighborhood& part) const {
    return {part.number / kFan, parent_of(part.number)};
  }

  /// Call visit(point) for all points whose squared distance from `query` is below `limit`.
  template <typename Visit>
  void for_each_near(const Box& query, double limit, const Visit& visit) const {
    if (!points_.empty())
      descend(levels_.size() - 1, 0, query, limit,
              [&](std::size_t group) { visit_group(group, query, limit, visit); });
  }

  /// Call visit(group) for the groups of eight leaves that may have points nearer than that.
  template <typename Visit>
  void for_each_group_near(const Box& query, double limit, const Visit& visit) const {
    if (!points_.empty()) descend(levels_.size() - 1, 0, query, limit, visit);
  }

  /// As for_each_near, in one group alone.
  template <typename Visit>
  void visit_group(std::size_t group, const Box& query, double limit, const Visit& visit) const {
    for_each_bit(near_bits(levels_[0][group], query, limit), [&](std::size_t k) {
      const std::size_t leaf = kFan * group + k;
      for_each_bit(near_bits(leaves_[leaf], query, limit),
                   [&](std::size_t p) { visit(kFan * leaf + p); });
    });
  }

  /// Call visit(point) for at least all points whose squared distance from `query` is below
  /// `limit`, which visit() may lower, near boxes first.
  template <typename Visit>
  void for_each_nearest(const Box& query, const double& limit, const Visit& visit) const {
    if (!points_.empty()) descend_nearest(levels_.size() - 1, 0, query, limit, visit);
  }

 private:
  /// Eight boxes that have one parent.
  struct Group {
    Eight low, high;
  };

  [[nodiscard]] Box box(std::size_t level, std::size_t k) const;
  [[nodiscard]] Box around(std::size_t level, std::size_t k) const;
  [[nodiscard]] Box parent_of(std::size_t leaf) const {
    return levels_.size() > 1 ? box(1, leaf / kFan) : around_all();
  }
  [[nodiscard]] Box around_all() const { return around(1, 0); }
  void put_points(std::size_t leaf);
  void put(std::size_t level, std::size_t k, const Box& box);
  /// Bits of those of eight whose squared distance is below a limit.
  [[nodiscard]] unsigned near_bits(const Group& group, const Box& query, double limit) const {
    return compare_(group.low, group.high, query, limit);
  }
  [[nodiscard]] unsigned near_bits(const Eight& points, const Box& query, double limit) const {
    return compare_(points, points, query, limit);
  }
  template <typename Visit>
  static void for_each_bit(unsigned bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(std::countr_zero(bits)));
  }
  [[nodiscard]] std::size_t last_point(std::size_t leaf) const {
    return std::min(kFan * (leaf + 1), points_.size());
  }

  template <typename Visit>
  void descend(std::size_t level, std::size_t group, const Box& query, double limit,
               const Visit& visit) const {
    if (level == 0) return visit(group);
    for_each_bit(near_bits(levels_[level][group], query, limit),
                 [&](std::size_t k) { descend(level - 1, kFan * group + k, query, limit, visit); });
  }

  template <typename Visit>
  void descend_nearest(std::size_t level, std::size_t group, const Box& query, const double& limit,
                       const Visit& visit) const {
    const Group& boxes = levels_[level][group];
    const unsigned near = near_bits(boxes, query, limit);
    if (std::popcount(near) < 2)
      return for_each_bit(near, [&](std::size_t k) {
        descend_to_nearest(level, kFan * group + k, query, limit, visit);
      });
    const std::array<double, kFan> distances = squared_distances(boxes.low, boxes.high, query);
    std::array<std::size_t, kFan> order;
    std::size_t count = 0;
    for_each_bit(near, [&](std::size_t k) {
      std::size_t place = count++;
      for (; place > 0 && distances[k] < distances[order[place - 1]]; --place)
        order[place] = order[place - 1];
      order[place] = k;
    });
    for (std::size_t k = 0; k < count && distances[order[k]] < limit; ++k)
      descend_to_nearest(level, kFan * group + order[k], query, limit, visit);
  }

  template <typename Visit>
  void descend_to_nearest(std::size_t level, std::size_t child, const Box& query,
                          const double& limit, const Visit& visit) const {
    if (level > 0) return descend_nearest(level - 1, child, query, limit, visit);
    for_each_bit(near_bits(leaves_[child], query, limit),
                 [&](std::size_t p) { visit(kFan * child + p); });
  }

  CompareBoxes compare_ = compare_boxes();
  std::span<const Vec3> points_;
  std::vector<Eight> leaves_;               // the points; what is missing in one is far away
  std::vector<std::vector<Group>> levels_;  // the leaves first; what is missing in a group is empty
};

}  // namespace dapple
