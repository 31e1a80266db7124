// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/texture.hpp>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kFilled = 0.8;        // share of the progress before the margin
constexpr double kOnEdge = -1e-12;     // least barycentric coordinate of a center on an edge
constexpr std::size_t kGrain = 65536;  // texels between two checks

void check(const Surface& surface, std::span<const FaceUv> uv, std::size_t rows,
           std::size_t columns, int margin) {
  check_uv(surface, uv);
  if (rows == 0 || columns == 0)
    throw ArgumentError(std::string(rows == 0 ? "rows" : "columns") +
                        " is 0: at least 1 is needed");
  check_pixels("the picture", rows, columns);
  check_at_least("margin", margin, 0.0);
}

/// A face on the picture, in texels: the center of texel (row, column) is (column, row) + 0.5.
class TexelTriangle {
 public:
  TexelTriangle(const FaceUv& uv, std::size_t rows, std::size_t columns) {
    const Vec2 size(static_cast<double>(columns), static_cast<double>(rows));
    for (std::size_t k = 0; k < 3; ++k) corners_[k] = uv[k].cwiseProduct(size);
    Eigen::Matrix2d edges;
    edges << corners_[1] - corners_[0], corners_[2] - corners_[0];
    flat_ = std::abs(edges.determinant()) < 1e-12;
    if (!flat_) inverse_ = edges.inverse();
  }

  [[nodiscard]] bool flat() const { return flat_; }  // without extent on the picture
  [[nodiscard]] Vec2 low() const { return corners_[0].cwiseMin(corners_[1]).cwiseMin(corners_[2]); }
  [[nodiscard]] Vec2 high() const {
    return corners_[0].cwiseMax(corners_[1]).cwiseMax(corners_[2]);
  }
  [[nodiscard]] Vec3 barycentric(std::size_t row, std::size_t column) const {
    const Vec2 p(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    const Vec2 w = inverse_ * (p - corners_[0]);
    return {1.0 - w.sum(), w.x(), w.y()};
  }

 private:
  std::array<Vec2, 3> corners_;
  Eigen::Matrix2d inverse_ = Eigen::Matrix2d::Zero();
  bool flat_ = false;
};

/// The first and one past the last texel whose center can lie in [low, high].
std::pair<std::size_t, std::size_t> range(double low, double high, std::size_t size) {
  const double end = static_cast<double>(size);
  return {static_cast<std::size_t>(std::clamp(std::floor(low - 0.5), 0.0, end)),
          static_cast<std::size_t>(std::clamp(std::floor(high - 0.5) + 2.0, 0.0, end))};
}

void fill(const TexelTriangle& triangle, std::int32_t face, Texels& result,
          const Context* context) {
  if (triangle.flat()) return;
  const auto [top, bottom] = range(triangle.low().y(), triangle.high().y(), result.rows);
  const auto [left, right] = range(triangle.low().x(), triangle.high().x(), result.columns);
  for (std::size_t row = top; row < bottom; ++row) {
    if (context) context->check();
    for (std::size_t column = left; column < right; ++column) {
      const std::size_t k = row * result.columns + column;
      if (result.faces[k] >= 0) continue;
      const Vec3 weights = triangle.barycentric(row, column);
      if (weights.minCoeff() < kOnEdge) continue;
      result.faces[k] = face;
      result.barycentric[k] = weights;
    }
  }
}

/// Texels with a face next to texels without one; the margin grows by one texel at a time.
class Margin {
 public:
  Margin(std::span<const FaceUv> uv, Texels& texels, const Context* context)
      : uv_(uv), texels_(texels), context_(context) {
    for (std::size_t k = 0; k < texels_.size(); ++k) {
      check_at(context_, k, kGrain);
      if (texels_.faces[k] >= 0) front_.push_back(k);
    }
  }

  [[nodiscard]] bool grows() const { return !front_.empty(); }

  void grow() {
    std::vector<std::size_t> next;
    for (std::size_t at = 0; at < front_.size(); ++at) {
      check_at(context_, at, kGrain);
      const std::size_t k = front_[at];
      const std::size_t row = k / texels_.columns;
      const std::size_t column = k % texels_.columns;
      if (row > 0) take(k, k - texels_.columns, next);
      if (row + 1 < texels_.rows) take(k, k + texels_.columns, next);
      if (column > 0) take(k, k - 1, next);
      if (column + 1 < texels_.columns) take(k, k + 1, next);
    }
    front_ = std::move(next);
  }

 private:
  void take(std::size_t from, std::size_t to, std::vector<std::size_t>& next) {
    if (texels_.faces[to] >= 0) return;
    const std::int32_t face = texels_.faces[from];
    texels_.faces[to] = face;
    texels_.barycentric[to] =
        TexelTriangle(uv_[static_cast<std::size_t>(face)], texels_.rows, texels_.columns)
            .barycentric(to / texels_.columns, to % texels_.columns);
    next.push_back(to);
  }

  std::span<const FaceUv> uv_;
  Texels& texels_;
  const Context* context_;
  std::vector<std::size_t> front_;
};

void report(Context& context, std::size_t done, std::size_t count) {
  context.check();
  context.advance(kFilled * static_cast<double>(done) / static_cast<double>(count));
}

}  // namespace

Texels texels(const Surface& surface, std::span<const FaceUv> uv, std::size_t rows,
              std::size_t columns, int margin, Context* context) {
  check(surface, uv, rows, columns, margin);
  Texels result{rows, columns, {}, {}};
  result.faces.reserve(rows * columns);
  result.barycentric.reserve(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {  // the first write to memory is slow
    check_context(context);
    result.faces.insert(result.faces.end(), columns, -1);
    result.barycentric.insert(result.barycentric.end(), columns, Vec3::Zero());
  }
  for (std::size_t f = 0; f < uv.size(); ++f) {
    if (context) report(*context, f, uv.size());
    fill(TexelTriangle(uv[f], rows, columns), static_cast<std::int32_t>(f), result, context);
  }
  Margin outside(uv, result, context);
  for (int k = 0; k < margin && outside.grows(); ++k) outside.grow();
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
