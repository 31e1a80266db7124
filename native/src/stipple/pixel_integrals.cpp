// SPDX-License-Identifier: GPL-3.0-or-later
#include "stipple/pixel_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

/// std::floor(), which is a function call on machines without an instruction for it.
double floor_of(double x) {
  const auto toward_zero = static_cast<double>(static_cast<std::int64_t>(x));
  return toward_zero > x ? toward_zero - 1.0 : toward_zero;
}

/// The parameters at which a coordinate moving from p to q is an integer, in order.
class Crossings {
 public:
  Crossings(double p, double q) : p_(p), d_(q - p), step_(q > p ? 1.0 : -1.0) {
    line_ = q > p ? floor_of(p) + 1.0 : -floor_of(-p) - 1.0;
    if (p != q) next_ = (line_ - p_) / d_;
  }
  [[nodiscard]] double next() const { return next_; }
  void advance() {
    line_ += step_;
    next_ = (line_ - p_) / d_;
  }

 private:
  double p_, d_, step_, line_ = 0.0;
  double next_ = std::numeric_limits<double>::infinity();
};

std::int32_t pixel(double middle, std::size_t count) {
  return std::clamp(static_cast<std::int32_t>(middle), 0, static_cast<std::int32_t>(count) - 1);
}

}  // namespace

void PixelIntegrals::reset(const FlatPolygon& polygon, const Vec2& origin) {
  origin_ = origin;
  pieces_.clear();
  starts_.clear();
  const std::size_t count = polygon.corners.size();
  for (std::size_t k = 0; k < count; ++k) {
    starts_.push_back(pieces_.size());
    split(polygon.corners[k].x + origin, polygon.corners[k + 1 < count ? k + 1 : 0].x + origin);
  }
  starts_.push_back(pieces_.size());
  add_up_rows();
}

void PixelIntegrals::split(const Vec2& p, const Vec2& q) {
  Crossings columns(p.x(), q.x()), rows(p.y(), q.y());
  Vec2 a = p;
  for (bool more = true; more;) {
    const double x = columns.next(), y = rows.next();
    const double t = std::min(x, y);
    more = t < 1.0;
    const Vec2 b = more ? Vec2(p + t * (q - p)) : q;
    const Vec2 middle = 0.5 * (a + b);
    pieces_.push_back({a, b, pixel(middle.x(), image_->columns), pixel(middle.y(), image_->rows)});
    if (x <= t) columns.advance();
    if (y <= t) rows.advance();
    a = b;
  }
}

void PixelIntegrals::add_up_rows() {
  rows_.clear();
  left_.clear();
  if (pieces_.empty()) return;
  const auto [low, high] = std::minmax_element(
      pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) { return a.row < b.row; });
  first_row_ = low->row;
  rows_.assign(static_cast<std::size_t>(high->row - first_row_) + 1,
               {std::numeric_limits<std::int32_t>::max(), -1, 0});
  for (const Piece& piece : pieces_) {
    Row& row = rows_[static_cast<std::size_t>(piece.row - first_row_)];
    row.first = std::min(row.first, piece.column);
    row.last = std::max(row.last, piece.column);
  }
  std::int32_t r = first_row_;
  for (Row& row : rows_) {
    row.start = left_.size();
    Left sum;
    for (std::int32_t c = row.first; c <= row.last; ++c) {
      left_.push_back(sum);
      const double phi = density(c, r), x = c + 0.5 - origin_.x();
      sum.capacity += phi;
      sum.mass += phi * phi;
      sum.first += phi * phi * x;
      sum.second += phi * phi * (x * x + 1.0 / 12.0);
    }
    ++r;
  }
}

void PixelIntegrals::add(const Piece& piece, Moments& sum) const {
  constexpr double kGauss = 0.28867513459481288225;  // 1 / (2 sqrt(3))
  const Row& row = rows_[static_cast<std::size_t>(piece.row - first_row_)];
  const Left& left = left_[row.start + static_cast<std::size_t>(piece.column - row.first)];
  const double phi = density(piece.column, piece.row), weight = 0.5 * (piece.b.y() - piece.a.y());
  const double start = piece.column - origin_.x();
  for (const double t : {0.5 - kGauss, 0.5 + kGauss}) {
    const Vec2 p = piece.a + t * (piece.b - piece.a) - origin_;
    const double x = p.x(), y = p.y();
    const double mass = left.mass + phi * phi * (x - start);
    sum.area += weight * x;
    sum.capacity += weight * (left.capacity + phi * (x - start));
    sum.mass += weight * mass;
    sum.first.x() += weight * (left.first + phi * phi * 0.5 * (x * x - start * start));
    sum.first.y() += weight * y * mass;
    sum.second += weight * (left.second + phi * phi / 3.0 * (x * x * x - start * start * start) +
                            y * y * mass);
  }
}

Moments PixelIntegrals::moments() const {
  Moments sum;
  for (const Piece& piece : pieces_)
    if (piece.a.y() != piece.b.y()) add(piece, sum);
  return sum;
}

PixelIntegrals::Edge PixelIntegrals::along(std::size_t k) const {
  Edge edge;
  for (const Piece& piece : std::span(pieces_).subspan(starts_[k], starts_[k + 1] - starts_[k])) {
    const double length = (piece.b - piece.a).norm();
    edge.length += length;
    edge.flux += density(piece.column, piece.row) * length * (0.5 * (piece.a + piece.b) - origin_);
  }
  return edge;
}

}  // namespace dapple
