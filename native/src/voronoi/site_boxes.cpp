// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/site_boxes.hpp"

#include <limits>

#include "base/parallel.hpp"

namespace dapple {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kGrain = 512;  // boxes

const Box kEmpty = {Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};

std::size_t groups_of(std::size_t boxes) { return (boxes + SiteBoxes::kFan - 1) / SiteBoxes::kFan; }

void extend(Box& box, const Box& other) {
  box.low = box.low.cwiseMin(other.low);
  box.high = box.high.cwiseMax(other.high);
}

}  // namespace

void SiteBoxes::assign(std::span<const Vec3> points) {
  points_ = points;
  std::size_t count = groups_of(points.size()), level = 0;
  leaves_.resize(count);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) put_points(leaf);
  });
  for (; count > 0; ++level) {
    if (level == levels_.size()) levels_.emplace_back();
    levels_[level].resize(groups_of(count));
    parallel_chunks(kFan * levels_[level].size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        put(level, k, k < count ? around(level, k) : kEmpty);
    });
    count = count > 1 ? groups_of(count) : 0;
  }
  levels_.resize(level);
}

void SiteBoxes::put_points(std::size_t leaf) {
  const std::size_t count = last_point(leaf) - kFan * leaf;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < kFan; ++k)
      leaves_[leaf][axis][k] =
          k < count ? points_[kFan * leaf + k][static_cast<Eigen::Index>(axis)] : kInfinity;
}

/// The contents of box k of a level: points, or boxes of the level below.
Box SiteBoxes::around(std::size_t level, std::size_t k) const {
  Box result = kEmpty;
  if (level == 0) {
    for (std::size_t p = kFan * k; p < last_point(k); ++p) extend(result, {points_[p], points_[p]});
  } else {
    for (std::size_t child = kFan * k; child < kFan * (k + 1); ++child)
      extend(result, box(level - 1, child));
  }
  return result;
}

Box SiteBoxes::box(std::size_t level, std::size_t k) const {
  const Group& group = levels_[level][k / kFan];
  Box result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.low[static_cast<Eigen::Index>(axis)] = group.low[axis][k % kFan];
    result.high[static_cast<Eigen::Index>(axis)] = group.high[axis][k % kFan];
  }
  return result;
}

void SiteBoxes::put(std::size_t level, std::size_t k, const Box& box) {
  Group& group = levels_[level][k / kFan];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    group.low[axis][k % kFan] = box.low[static_cast<Eigen::Index>(axis)];
    group.high[axis][k % kFan] = box.high[static_cast<Eigen::Index>(axis)];
  }
}

}  // namespace dapple
