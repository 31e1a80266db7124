// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>
#include <vector>

namespace dapple {

/// A convex polygon in the plane, counter-clockwise, relative to its site.
struct FlatPolygon {
  struct Corner {
    Vec2 x;
    std::int32_t edge;  ///< label of the edge that begins here
  };

  /// Clip to the half-plane normal . x <= offset; the new edge gets the label.
  /// \return whether anything was cut off
  bool cut(const Vec2& normal, double offset, std::int32_t label);

  /// Squared distance of the corner farthest from the site; 0 if there is none.
  [[nodiscard]] double squared_radius() const;

  std::vector<Corner> corners;

 private:
  std::vector<Corner> kept_;
};

}  // namespace dapple
