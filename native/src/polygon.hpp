// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <algorithm>
#include <span>

namespace dapple {

/// A convex polygon being clipped; buffers are kept from one face to the next.
class Polygon {
 public:
  struct Corner {
    Vec3 x;             ///< relative to the site
    double side;        ///< signed distance (scaled) to the plane that clips at the moment
    std::int32_t edge;  ///< what the edge to the next corner lies on: plane k >= 0, or face edge -1-k
  };

  /// Begin with a triangle; its edge k runs from corner k to corner k + 1.
  void start(const Vec3& a, const Vec3& b, const Vec3& c) {
    corners_.resize(3);
    corners_[0] = {a, 0.0, -1};
    corners_[1] = {b, 0.0, -2};
    corners_[2] = {c, 0.0, -3};
  }

  /// Keep the part with x . normal <= offset; new edges are marked `plane`. True if anything was cut off.
  bool clip(const Vec3& normal, double offset, std::int32_t plane) {
    bool outside = false;
    for (Corner& corner : corners_) {
      corner.side = corner.x.dot(normal) - offset;
      outside = outside || corner.side > 0.0;
    }
    if (outside) cut(plane);
    return outside;
  }

  [[nodiscard]] bool empty() const { return corners_.empty(); }
  [[nodiscard]] std::span<const Corner> corners() const { return corners_; }

  /// Squared distance of the farthest corner from the site.
  [[nodiscard]] double squared_radius() const {
    double radius = 0.0;
    for (const Corner& corner : corners_) radius = std::max(radius, corner.x.squaredNorm());
    return radius;
  }

 private:
  // Sutherland and Hodgman: walk the corners, keep those inside, add one where an edge crosses the plane.
  void cut(std::int32_t plane) {
    kept_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Corner& a = corners_[k];
      const Corner& b = corners_[k + 1 < corners_.size() ? k + 1 : 0];
      if (a.side <= 0.0) kept_.push_back(a);
      if ((a.side <= 0.0) == (b.side <= 0.0)) continue;
      const double t = a.side / (a.side - b.side);
      kept_.push_back({a.x + t * (b.x - a.x), 0.0, a.side <= 0.0 ? plane : a.edge});
    }
    corners_.swap(kept_);
  }

  std::vector<Corner> corners_;
  std::vector<Corner> kept_;
};

}  // namespace dapple
