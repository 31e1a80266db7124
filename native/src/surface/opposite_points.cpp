// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/opposite_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"

namespace dapple {
namespace {

constexpr std::size_t kLeaf = 16;    // points
constexpr std::size_t kGrain = 256;  // leaves per chunk
constexpr double kSlack = 1e-9;      // relative, for rounding

/// The range of some vectors along each axis.
struct Range {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& low_end, const Vec3& high_end) {
    low = low.cwiseMin(low_end);
    high = high.cwiseMax(high_end);
  }
};

double squared_distance(const Range& a, const Range& b) {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).squaredNorm();
}

double least_product(const Range& a, const Range& b) {
  const Vec3 least = a.low.cwiseProduct(b.low)
                         .cwiseMin(a.low.cwiseProduct(b.high))
                         .cwiseMin(a.high.cwiseProduct(b.low))
                         .cwiseMin(a.high.cwiseProduct(b.high));
  return least.sum();
}

/// Compares only groups of points that are near and whose normals may be opposite, as most of a
/// surface is neither.
class Search {
 public:
  Search(const LaidPoints& points, const Opposition& opposition, std::size_t fewest)
      : points_(points),
        opposition_(opposition),
        fewest_(fewest),
        has_opposite_(points.positions.size(), 0) {
    begin_levels();
  }

  bool run() {
    if (!levels_.empty()) compare(levels_.size() - 1, 0, 0);
    return found_ >= fewest_;
  }

 private:
  struct Group {
    Range positions, normals;
  };

  void begin_levels() {
    const std::size_t count = points_.positions.size();
    std::vector<Group> leaves((count + kLeaf - 1) / kLeaf);
    parallel_chunks(leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = kLeaf * begin; k < std::min(count, kLeaf * end); ++k) {
        leaves[k / kLeaf].positions.add(points_.positions[k], points_.positions[k]);
        leaves[k / kLeaf].normals.add(points_.normals[k], points_.normals[k]);
      }
    });
    if (!leaves.empty()) levels_.push_back(std::move(leaves));
    while (!levels_.empty() && levels_.back().size() > 1) levels_.push_back(halved(levels_.back()));
  }

  static std::vector<Group> halved(const std::vector<Group>& groups) {
    std::vector<Group> result((groups.size() + 1) / 2);
    for (std::size_t k = 0; k < groups.size(); ++k) {
      result[k / 2].positions.add(groups[k].positions.low, groups[k].positions.high);
      result[k / 2].normals.add(groups[k].normals.low, groups[k].normals.high);
    }
    return result;
  }

  /// Compare the points of two groups of a level with each other; a <= b.
  void compare(std::size_t level, std::size_t a, std::size_t b) {
    if (found_ >= fewest_ || !may_oppose(levels_[level][a], levels_[level][b])) return;
    if (level == 0) return compare_points(a, b);
    const std::size_t last = levels_[level - 1].size();
    for (std::size_t i = 2 * a; i < std::min(2 * a + 2, last); ++i)
      for (std::size_t j = std::max(i, 2 * b); j < std::min(2 * b + 2, last); ++j)
        compare(level - 1, i, j);
  }

  [[nodiscard]] bool may_oppose(const Group& a, const Group& b) const {
    const double reach = (1.0 + kSlack) * opposition_.reach;
    return squared_distance(a.positions, b.positions) <= reach * reach &&
           least_product(a.normals, b.normals) < opposition_.cosine + kSlack;
  }

  void compare_points(std::size_t a, std::size_t b) {
    const std::size_t count = points_.positions.size();
    for (std::size_t i = kLeaf * a; i < std::min(count, kLeaf * (a + 1)); ++i)
      for (std::size_t j = std::max(i + 1, kLeaf * b); j < std::min(count, kLeaf * (b + 1)); ++j)
        if (face_away(i, j)) {
          note(i, j);
          note(j, i);
        }
  }

  [[nodiscard]] bool face_away(std::size_t i, std::size_t j) const {
    const Vec3 way = points_.positions[j] - points_.positions[i];
    return way.squaredNorm() < opposition_.reach * opposition_.reach &&
           points_.components[i] == points_.components[j] &&
           points_.normals[i].dot(points_.normals[j]) < opposition_.cosine;
  }

  void note(std::size_t point, std::size_t other) {
    const Vec3 way = points_.positions[other] - points_.positions[point];
    if (has_opposite_[point] || !(std::abs(way.dot(points_.normals[point])) < opposition_.depth))
      return;
    has_opposite_[point] = 1;
    ++found_;
  }

  const LaidPoints& points_;
  const Opposition opposition_;
  const std::size_t fewest_;
  std::vector<char> has_opposite_;          // per point
  std::size_t found_ = 0;                   // points that have one
  std::vector<std::vector<Group>> levels_;  // groups of kLeaf points, then pairs of groups
};

}  // namespace

bool has_opposite_points(const LaidPoints& points, const Opposition& opposition,
                         std::size_t fewest) {
  return Search(points, opposition, fewest).run();
}

}  // namespace dapple
