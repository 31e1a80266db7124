// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/types.hpp>
#include <limits>
#include <span>

#include "base/triple.hpp"

namespace dapple {

/// A convex polygon being clipped; buffers are kept from one face to the next.
class Polygon {
 public:
  struct Corner {
    Vec3 x;  ///< relative to the site
    /// The line of the edge to the next corner: plane k >= 0, or face edge -1-k.
    std::int32_t edge;
  };

  /// Begin with a triangle; its edge k runs from corner k to corner k + 1.
  void start(const Triple& a, const Triple& b, const Triple& c) {
    put(corners_[0], a, -1);
    put(corners_[1], b, -2);
    put(corners_[2], c, -3);
    size_ = 3;
    squared_radius_ = std::max(std::max(a.squared_norm(), b.squared_norm()), c.squared_norm());
  }

  /// Begin with the corners of a convex polygon.
  void start(std::span<const Corner> corners) {
    make_room(corners.size());
    std::copy(corners.begin(), corners.end(), corners_.begin());
    size_ = corners.size();
    squared_radius_ = 0.0;
    for (const Corner& corner : corners)
      squared_radius_ = std::max(squared_radius_, Triple(corner.x).squared_norm());
  }

  /// The least and the largest of x . normal - offset over the corners.
  struct Range {
    double low, high;
  };
  Range measure(const Vec3& normal, double offset) {
    const Triple n(normal);
    const Corner* const corners = corners_.data();
    double* const sides = sides_.data();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0, size = size_; k < size; ++k) {
      const double side = Triple(corners[k].x).dot(n) - offset;
      sides[k] = side;
      low = std::min(low, side);
      high = std::max(high, side);
    }
    sides[size_] = sides[0];
    return {low, high};
  }

  /// Keep the part that was measured as not above 0; new edges are marked `plane`.
  // Sutherland and Hodgman: walk the corners, keep those inside, add one where an edge crosses the
  // plane. Rounding can make a polygon so slightly concave that a plane adds more than one. A
  // processor cannot predict which corners are inside, so there is no branch: what could be kept
  // is written, and counts or not.
  void cut(std::int32_t plane) {
    const std::size_t size = size_;
    Corner* const corners = corners_.data();
    Corner* const kept = kept_.data();
    const double* const sides = sides_.data();
    put(corners[size], Triple(corners[0].x), corners[0].edge);
    std::size_t count = 0;
    double radius = 0.0;
    for (std::size_t k = 0; k < size; ++k) {
      const double side = sides[k], next = sides[k + 1];
      const std::int32_t edge = corners[k].edge;
      const int inside = side <= 0.0 ? 1 : 0, crossing = inside ^ (next <= 0.0 ? 1 : 0);
      const Triple a(corners[k].x);
      put(kept[count], a, edge);
      radius = std::max(radius, inside * a.squared_norm());
      count += static_cast<std::size_t>(inside);
      const Triple x = a + side / (side - next) * (Triple(corners[k + 1].x) - a);
      put(kept[count], x, edge + inside * (plane - edge));
      radius = std::max(radius, crossing * x.squared_norm());
      count += static_cast<std::size_t>(crossing);
    }
    corners_.swap(kept_);
    size_ = count;
    squared_radius_ = radius;
    make_room(count);
  }

  void clear() { size_ = 0; }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::span<const Corner> corners() const { return {corners_.data(), size_}; }

  /// Squared distance of the farthest corner from the site; clear() leaves it.
  [[nodiscard]] double squared_radius() const { return squared_radius_; }

 private:
  // Member by member, because copying the whole stalls on partial writes.
  static void put(Corner& corner, const Triple& x, std::int32_t edge) {
    x.store(corner.x);
    corner.edge = edge;
  }

  /// Capacity for the corners of ordinary polygons and for the corners that a cut adds.
  void make_room(std::size_t size) {
    if (2 * size + 1 <= kept_.size()) return;
    corners_.resize(4 * size + 1);
    kept_.resize(4 * size + 1);
    sides_.resize(4 * size + 1);
  }

  static constexpr std::size_t kRoom = 32;
  std::vector<Corner> corners_ = std::vector<Corner>(kRoom);  // the first size_ count
  std::vector<Corner> kept_ = std::vector<Corner>(kRoom);
  std::vector<double> sides_ =
      std::vector<double>(kRoom);  // of the plane measured last, per corner
  std::size_t size_ = 0;
  double squared_radius_ = 0.0;
};

}  // namespace dapple
