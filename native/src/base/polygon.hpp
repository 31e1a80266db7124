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
    Vec3 x;       ///< relative to the site
    double side;  ///< signed distance (scaled) to the plane that clips at the moment
    std::int32_t
        edge;  ///< what the edge to the next corner lies on: plane k >= 0, or face edge -1-k
  };

  /// Begin with a triangle; its edge k runs from corner k to corner k + 1.
  void start(const Vec3& a, const Vec3& b, const Vec3& c) {
    corners_[0] = {a, 0.0, -1};
    corners_[1] = {b, 0.0, -2};
    corners_[2] = {c, 0.0, -3};
    size_ = 3;
  }

  /// Begin with the corners of a convex polygon.
  void start(std::span<const Corner> corners) {
    if (corners_.size() < corners.size()) corners_.resize(corners.size());
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
      corners_[k].side = side;
      range.low = std::min(range.low, side);
      range.high = std::max(range.high, side);
    }
    return range;
  }

  /// Keep the part that was measured as not above 0; new edges are marked `plane`.
  // Sutherland and Hodgman: walk the corners, keep those inside, add one where an edge crosses the
  // plane. Room is checked at each corner: rounding can make a polygon so slightly concave that a
  // plane adds more than one.
  void cut(std::int32_t plane) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < size_; ++k) {
      const Corner& a = corners_[k];
      const Corner& b = corners_[k + 1 < size_ ? k + 1 : 0];
      const bool inside = a.side <= 0.0;
      if (kept + 2 > kept_.size()) kept_.resize(2 * kept_.size());
      if (inside) kept_[kept++] = a;
      if (inside == (b.side <= 0.0)) continue;
      const double t = a.side / (a.side - b.side);
      kept_[kept++] = {a.x + t * (b.x - a.x), 0.0, inside ? plane : a.edge};
    }
    corners_.swap(kept_);
    size_ = kept;
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
  std::vector<Corner> corners_ = std::vector<Corner>(16);  // the first size_ count
  std::vector<Corner> kept_ = std::vector<Corner>(16);
  std::size_t size_ = 0;
};

}  // namespace dapple
