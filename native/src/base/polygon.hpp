// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/types.hpp>
#include <limits>
#include <span>

namespace dapple {

/// A convex polygon being clipped; buffers are kept from one face to the next.
class Polygon {
 public:
  struct Corner {
    Vec3 x;  ///< relative to the site
    /// What the edge to the next corner lies on: plane k >= 0, or face edge -1-k.
    std::int32_t edge;
  };

  /// Begin with a triangle; its edge k runs from corner k to corner k + 1.
  void start(const Vec3& a, const Vec3& b, const Vec3& c) {
    corners_[0] = {a, -1};
    corners_[1] = {b, -2};
    corners_[2] = {c, -3};
    size_ = 3;
  }

  /// Begin with the corners of a convex polygon.
  void start(std::span<const Corner> corners) {
    if (corners_.size() < corners.size()) corners_.resize(corners.size());
    if (sides_.size() < corners_.size()) sides_.resize(corners_.size());
    std::copy(corners.begin(), corners.end(), corners_.begin());
    size_ = corners.size();
  }

  /// The least and the largest of x . normal - offset over the corners.
  struct Range {
    double low, high;
  };
  Range measure(const Vec3& normal, double offset) {
    Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < size_; ++k) {
      const double side = corners_[k].x.dot(normal) - offset;
      sides_[k] = side;
      range.low = std::min(range.low, side);
      range.high = std::max(range.high, side);
    }
    return range;
  }

  /// Keep the part that was measured as not above 0; new edges are marked `plane`.
  // Sutherland and Hodgman: walk the corners, keep those inside, add one where an edge crosses the
  // plane. Rounding can make a polygon so slightly concave that a plane adds more than one.
  void cut(std::int32_t plane) {
    std::size_t kept = 0;
    if (2 * size_ > kept_.size()) kept_.resize(4 * size_);
    for (std::size_t k = 0; k < size_; ++k) {
      const std::size_t next = k + 1 < size_ ? k + 1 : 0;
      const Corner& a = corners_[k];
      const bool inside = sides_[k] <= 0.0;
      if (inside) keep(kept++, a.x, a.edge);
      if (inside == (sides_[next] <= 0.0)) continue;
      const double t = sides_[k] / (sides_[k] - sides_[next]);
      keep(kept++, a.x + t * (corners_[next].x - a.x), inside ? plane : a.edge);
    }
    corners_.swap(kept_);
    size_ = kept;
    if (sides_.size() < corners_.size()) sides_.resize(corners_.size());
  }

  void clear() { size_ = 0; }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::span<const Corner> corners() const { return {corners_.data(), size_}; }

  /// Squared distance of the farthest corner from the site.
  [[nodiscard]] double squared_radius() const {
    double radius = 0.0;
    for (std::size_t k = 0; k < size_; ++k) radius = std::max(radius, corners_[k].x.squaredNorm());
    return radius;
  }

 private:
  // Member by member: a copy of the whole would wait for what was written in parts.
  void keep(std::size_t k, const Vec3& x, std::int32_t edge) {
    kept_[k].x = x;
    kept_[k].edge = edge;
  }

  std::vector<Corner> corners_ = std::vector<Corner>(16);  // the first size_ count
  std::vector<Corner> kept_ = std::vector<Corner>(16);
  std::vector<double> sides_ = std::vector<double>(16);  // of the plane measured last, per corner
  std::size_t size_ = 0;
};

}  // namespace dapple
