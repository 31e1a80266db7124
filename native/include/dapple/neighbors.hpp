// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <memory>
#include <span>

namespace dapple {

/// A neighbor: its index and the squared distance.
struct Neighbor {
  std::int32_t index;
  double squared_distance;
};

/// Nearest points of a fixed set, by a k-d tree.
class Neighbors {
 public:
  /// The points are not copied and must outlive the tree.
  explicit Neighbors(std::span<const Vec3> points);
  ~Neighbors();
  Neighbors(const Neighbors&) = delete;
  Neighbors& operator=(const Neighbors&) = delete;

  /// The `count` points nearest to `point` (all of them if there are fewer), sorted by distance,
  /// ties by index.
  void nearest(const Vec3& point, std::size_t count, std::vector<Neighbor>& result) const;

  /// All points nearer to `point` than `distance`, sorted likewise.
  void within(const Vec3& point, double distance, std::vector<Neighbor>& result) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Distance of each point to its nearest other point; infinite for a single point.
/// \throw ArgumentError naming the first point that is not finite
[[nodiscard]] std::vector<double> nearest_distances(std::span<const Vec3> points);

}  // namespace dapple
