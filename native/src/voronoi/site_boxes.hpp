// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// A box in space; a point is a box too.
struct Box {
  Vec3 low, high;
};

/// Boxes around runs of points that are sorted in space: eight points a leaf, eight boxes a box. No
/// links are kept, so that building it is one pass.
class SiteBoxes {
 public:
  static constexpr std::size_t kFan = 8;

  /// Of no points.
  SiteBoxes() = default;

  /// \param points must outlive the boxes
  explicit SiteBoxes(std::span<const Vec3> points) { assign(points); }

  /// Of other points, in the same memory.
  void assign(std::span<const Vec3> points);

  [[nodiscard]] Box leaf_of(std::size_t point) const { return box(0, point / kFan); }

  /// Call visit(point) for at least all points whose squared distance from `query` is below
  /// `limit`, which visit() may lower.
  template <typename Visit>
  void for_each_near(const Box& query, const double& limit, const Visit& visit) const {
    if (!points_.empty()) descend(levels_.size() - 1, 0, query, limit, visit);
  }

  /// The same, near boxes first: for a limit that sinks on the way.
  template <typename Visit>
  void for_each_nearest(const Box& query, const double& limit, const Visit& visit) const {
    if (!points_.empty()) descend_nearest(levels_.size() - 1, 0, query, limit, visit);
  }

 private:
  /// Eight boxes that have one parent: the bounds of each, by axis.
  struct Group {
    std::array<std::array<double, kFan>, 3> low, high;
  };
  using Distances = std::array<double, kFan>;

  [[nodiscard]] Box box(std::size_t level, std::size_t k) const;
  [[nodiscard]] Box around(std::size_t level, std::size_t k) const;
  void put(std::size_t level, std::size_t k, const Box& box);
  [[nodiscard]] static Distances squared_distances(const Group& group, const Box& query);
  [[nodiscard]] std::size_t last_point(std::size_t leaf) const {
    return std::min(kFan * (leaf + 1), points_.size());
  }

  template <typename Visit>
  void visit_leaf(std::size_t leaf, const Visit& visit) const {
    for (std::size_t p = kFan * leaf; p < last_point(leaf); ++p) visit(p);
  }

  template <typename Visit>
  void descend(std::size_t level, std::size_t group, const Box& query, const double& limit,
               const Visit& visit) const {
    const Distances distances = squared_distances(levels_[level][group], query);
    for (std::size_t k = 0; k < kFan; ++k) {
      if (!(distances[k] < limit)) continue;
      if (level > 0)
        descend(level - 1, kFan * group + k, query, limit, visit);
      else
        visit_leaf(kFan * group + k, visit);
    }
  }

  template <typename Visit>
  void descend_nearest(std::size_t level, std::size_t group, const Box& query, const double& limit,
                       const Visit& visit) const {
    const Distances distances = squared_distances(levels_[level][group], query);
    std::array<std::size_t, kFan> order = {0, 1, 2, 3, 4, 5, 6, 7};
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; });
    for (const std::size_t k : order) {
      if (!(distances[k] < limit)) return;
      const std::size_t child = kFan * group + k;
      if (level > 0)
        descend_nearest(level - 1, child, query, limit, visit);
      else
        visit_leaf(child, visit);
    }
  }

  std::span<const Vec3> points_;
  std::vector<std::vector<Group>> levels_;  // the leaves first; what is missing in a group is empty
};

}  // namespace dapple
