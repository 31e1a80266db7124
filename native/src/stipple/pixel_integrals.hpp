// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <dapple/types.hpp>
#include <span>

#include "plane/flat_polygon.hpp"

namespace dapple {

/// Exact integrals over polygons of a density that is constant on each pixel [c, c + 1] x [r, r +
/// 1] of an image; one per thread. The cost grows with the number of pixels that a polygon covers.
///
/// By Green's theorem, the integral of g is that of G dy around the polygon, where dG/dx = g. The
/// boundary is split at the pixels' lines; on a piece G is a polynomial of degree 3 at most, for
/// which Gauss's rule with two points is exact. G starts in each row at the polygon's first pixel,
/// so that it loses no digits.
class PixelIntegrals {
 public:
  /// \param image must outlive this
  explicit PixelIntegrals(const Image& image) : image_(&image) {}

  /// Start a polygon of the site at `origin`, inside the image.
  void reset(const FlatPolygon& polygon, const Vec2& origin);

  /// Integrals over the polygon, relative to the site.
  [[nodiscard]] Moments moments() const;

  /// Along the edge that begins at corner k: length, and integral of phi (x - origin) ds.
  struct Edge {
    double length = 0.0;
    Vec2 flux = Vec2::Zero();
  };
  [[nodiscard]] Edge along(std::size_t k) const;

 private:
  /// A part of an edge within one pixel, from a to b, in the image's coordinates.
  struct Piece {
    Vec2 a, b;
    std::int32_t column, row;
  };
  /// Integrals of phi and of phi^2 times 1, x, x^2 over the part of a row left of a pixel, per unit
  /// of height; x is relative to the site.
  struct Left {
    double capacity = 0.0, mass = 0.0, first = 0.0, second = 0.0;
  };
  struct Row {
    std::int32_t first, last;  // columns
    std::size_t start;         // in left_
  };

  void split(const Vec2& p, const Vec2& q);
  void add_up_rows();
  void add(const Piece& piece, Moments& sum) const;
  [[nodiscard]] double density(std::int32_t column, std::int32_t row) const {
    return image_->values[static_cast<std::size_t>(row) * image_->columns +
                          static_cast<std::size_t>(column)];
  }

  const Image* image_;
  Vec2 origin_ = Vec2::Zero();
  std::vector<Piece> pieces_;
  std::vector<std::size_t> starts_;  // of the pieces of each edge, and their end
  std::int32_t first_row_ = 0;
  std::vector<Row> rows_;
  std::vector<Left> left_;
};

}  // namespace dapple
