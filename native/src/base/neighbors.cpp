// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <limits>
#include <nanoflann.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"

namespace dapple {

struct Neighbors::Tree {
  // The interface that nanoflann requires of a point set.
  struct PointSet {
    std::span<const Vec3> points;
    bool building = true;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t point, std::size_t axis) const {
      if (building && axis == 0) check_at(point, 1024);
      return points[point][static_cast<Eigen::Index>(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Metric = nanoflann::L2_Simple_Adaptor<double, PointSet, double, std::int32_t>;
  using Index = nanoflann::KDTreeSingleIndexAdaptor<Metric, PointSet, 3, std::int32_t>;

  explicit Tree(std::span<const Vec3> points) : set{points}, index(3, set, {/*leaf_max_size=*/10}) {
    set.building = false;
  }

  PointSet set;
  Index index;
};

namespace {

/// A result set for nanoflann: all points within a distance.
class Ball {
 public:
  Ball(double squared_radius, std::vector<Neighbor>& found)
      : squared_radius_(squared_radius), found_(found) {}

  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] bool full() const { return true; }
  // NOLINTBEGIN(readability-identifier-naming): nanoflann's names
  using DistanceType = double;
  [[nodiscard]] double worstDist() const { return squared_radius_; }
  bool addPoint(double squared_distance, std::int32_t index) {
    if (squared_distance < squared_radius_) found_.push_back({index, squared_distance});
    return true;
  }
  // NOLINTEND(readability-identifier-naming)
  void sort() {}

 private:
  double squared_radius_;
  std::vector<Neighbor>& found_;
};

void sort_by_distance(std::vector<Neighbor>& found) {
  std::sort(found.begin(), found.end(), [](const Neighbor& a, const Neighbor& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                    : a.index < b.index;
  });
}

}  // namespace

Neighbors::Neighbors(std::span<const Vec3> points) : tree_(std::make_unique<Tree>(points)) {}
Neighbors::~Neighbors() = default;

void Neighbors::nearest(const Vec3& point, std::size_t count, std::vector<Neighbor>& result) const {
  count = std::min(count, tree_->set.points.size());
  result.clear();
  if (count == 0) return;
  std::vector<std::int32_t> indices(count);
  std::vector<double> distances(count);
  tree_->index.knnSearch(point.data(), count, indices.data(), distances.data());
  result.resize(count);
  for (std::size_t k = 0; k < count; ++k) result[k] = {indices[k], distances[k]};
  sort_by_distance(result);
}

void Neighbors::within(const Vec3& point, double distance, std::vector<Neighbor>& result) const {
  result.clear();
  if (tree_->set.points.empty()) return;
  Ball ball(distance * distance, result);
  tree_->index.radiusSearchCustomCallback(point.data(), ball);
  sort_by_distance(result);
}

std::vector<double> nearest_distances(std::span<const Vec3> points) {
  check_finite("points", points);
  std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
  if (points.size() < 2) return distances;
  const Neighbors tree(points);
  parallel_chunks(points.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t k = begin; k < end; ++k) {
      tree.nearest(points[k], 2, near);
      distances[k] = std::sqrt(near[1].squared_distance);
    }
  });
  return distances;
}

}  // namespace dapple
