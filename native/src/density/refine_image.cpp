// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/refine_image.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kCut = 0.8;       // share of the progress when all faces are cut
constexpr double kFilled = 0.9;    // share of the progress when they have their density
constexpr double kPatch = 32.0;    // pixels: larger pieces are not tested pixel by pixel
constexpr double kLinear = 1e-12;  // of the maximum: smaller second differences are rounding errors
constexpr double kLatticeStep = 0.5;  // pixels

/// A triangle on the picture, in pixels; (0, 0) is the center of the first.
using PixelTriangle = std::array<Vec2, 3>;

double longest_edge(const PixelTriangle& t) {
  return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

/// The picture as a function in the plane.
class Picture {
 public:
  Picture(const Image& image, bool repeat)
      : image_(&image),
        repeat_(repeat),
        size_(static_cast<double>(image.columns), static_cast<double>(image.rows)),
        maximum_(*std::max_element(image.values.begin(), image.values.end())) {
    count_bends();
  }

  [[nodiscard]] double maximum() const { return maximum_; }

  [[nodiscard]] Vec2 pixel(const Vec2& uv) const {
    return uv.cwiseProduct(size_) - Vec2::Constant(0.5);
  }

  /// The bilinear interpolation between the centers of pixels.
  [[nodiscard]] double operator()(const Vec2& at) const {
    const double x = std::floor(at.x()), y = std::floor(at.y());
    const double s = at.x() - x, t = at.y() - y;
    const std::size_t left = column(x), right = column(x + 1.0);
    const std::size_t low = row(y), high = row(y + 1.0);
    return (1.0 - t) * ((1.0 - s) * value(left, low) + s * value(right, low)) +
           t * ((1.0 - s) * value(left, high) + s * value(right, high));
  }

  /// Whether the picture may be nonlinear in the triangle's bounding box.
  [[nodiscard]] bool bends_over(const PixelTriangle& t) const {
    const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]).array().floor();
    const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]).array().floor() + 1.0;
    for (const auto& [left, right] : ranges(low.x(), high.x(), image_->columns))
      for (const auto& [bottom, top] : ranges(low.y(), high.y(), image_->rows))
        if (bends(left, right, bottom, top) > 0) return true;
    return false;
  }

 private:
  using Range = std::array<std::size_t, 2>;  // [first, end)

  [[nodiscard]] std::size_t index(double k, std::size_t count) const {
    const auto size = static_cast<double>(count);
    const double inside = repeat_ ? k - std::floor(k / size) * size : k;
    return static_cast<std::size_t>(std::clamp(inside, 0.0, size - 1.0));
  }
  [[nodiscard]] std::size_t column(double x) const { return index(x, image_->columns); }
  [[nodiscard]] std::size_t row(double y) const { return index(y, image_->rows); }
  [[nodiscard]] double value(std::size_t column, std::size_t row) const {
    return image_->values[row * image_->columns + column];
  }

  /// The pixels from low to high; two ranges if a repeated picture wraps around in between.
  [[nodiscard]] std::vector<Range> ranges(double low, double high, std::size_t count) const {
    if (!repeat_) return {{index(low, count), index(high, count) + 1}};
    if (high - low + 1.0 >= static_cast<double>(count)) return {{0, count}};
    const std::size_t first = index(low, count), last = index(high, count);
    if (first <= last) return {{first, last + 1}};
    return {{first, count}, {0, last + 1}};
  }

  /// Whether a second difference about a pixel is not zero.
  [[nodiscard]] bool bends_at(std::size_t c, std::size_t r) const {
    const auto x = static_cast<double>(c), y = static_cast<double>(r);
    const std::size_t left = column(x - 1.0), right = column(x + 1.0);
    const std::size_t low = row(y - 1.0), high = row(y + 1.0);
    const double middle = value(c, r);
    const auto bent = [&](double difference) { return std::abs(difference) > kLinear * maximum_; };
    return bent(value(left, r) - 2.0 * middle + value(right, r)) ||
           bent(value(c, low) - 2.0 * middle + value(c, high)) ||
           bent(middle - value(right, r) - value(c, high) + value(right, high));
  }

  void count_bends() {
    const std::size_t width = image_->columns + 1;
    sums_.assign(width * (image_->rows + 1), 0);
    for (std::size_t r = 0; r < image_->rows; ++r)
      for (std::size_t c = 0; c < image_->columns; ++c)
        sums_[(r + 1) * width + c + 1] = sums_[r * width + c + 1] + sums_[(r + 1) * width + c] -
                                         sums_[r * width + c] + (bends_at(c, r) ? 1 : 0);
  }

  [[nodiscard]] std::int64_t bends(std::size_t left, std::size_t right, std::size_t bottom,
                                   std::size_t top) const {
    const auto sum = [&](std::size_t c, std::size_t r) {
      return sums_[r * (image_->columns + 1) + c];
    };
    return sum(right, top) - sum(left, top) - sum(right, bottom) + sum(left, bottom);
  }

  const Image* image_;
  bool repeat_;
  Vec2 size_;
  double maximum_;
  std::vector<std::int64_t> sums_;  // sums of bent pixels to the left and below
};

/// Tests whether the error of linear interpolation between the triangle's corners exceeds the
/// tolerance, relative to the maximum, at some point of a lattice, or on average half of the
/// tolerance, relative to the mean. Without the second test, convex pictures would gain mass.
class Deviation {
 public:
  Deviation(const Picture& picture, const PixelTriangle& t)
      : picture_(&picture), t_(t), values_(picture(t[0]), picture(t[1]), picture(t[2])) {}

  [[nodiscard]] bool exceeds(double max_error) {
    const double most = max_error * picture_->maximum();
    const auto steps = static_cast<int>(std::ceil(longest_edge(t_) / kLatticeStep));
    const double third = 1.0 / (3.0 * steps);
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        const double x = i * 3.0 * third, y = j * 3.0 * third;
        if (add(x + third, y + third) > most) return true;
        if (i + j + 1 < steps && add(x + 2.0 * third, y + 2.0 * third) > most) return true;
      }
    return std::abs(excess_) > 0.5 * max_error * sum_;
  }

 private:
  /// Adds the middle of a part of the triangle; all parts have the same size.
  double add(double x, double y) {
    const Vec3 weights(x, y, 1.0 - x - y);
    const double value = (*picture_)(weights[0] * t_[0] + weights[1] * t_[1] + weights[2] * t_[2]);
    const double off = weights.dot(values_) - value;
    sum_ += value;
    excess_ += off;
    return std::abs(off);
  }

  const Picture* picture_;
  PixelTriangle t_;
  Vec3 values_;
  double sum_ = 0.0, excess_ = 0.0;
};

/// Maps a piece to the picture.
class Chart {
 public:
  Chart(const Picture& picture, std::span<const FaceUv> uv) : picture_(&picture), uv_(uv) {}

  [[nodiscard]] PixelTriangle triangle(std::int32_t parent,
                                       const std::array<Vec3, 3>& barycentric) const {
    const FaceUv& uv = uv_[static_cast<std::size_t>(parent)];
    PixelTriangle result;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& w = barycentric[k];
      result[k] = picture_->pixel(w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2]);
    }
    return result;
  }

 private:
  const Picture* picture_;
  std::span<const FaceUv> uv_;
};

double longest_edge(const Piece& piece) {
  const std::array<Vec3, 3>& c = piece.corners;
  return std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
}

/// The edges of a piece that are halved because the picture is not linear there; short edges are
/// not halved.
EdgeMarks unresolved_edges(const Picture& picture, const PixelTriangle& t, const Piece& piece,
                           const ImageOptions& options) {
  const double longest = longest_edge(t);
  if (longest <= options.texels || longest_edge(piece) <= options.shortest ||
      !picture.bends_over(t))
    return {};
  if (longest <= kPatch && !Deviation(picture, t).exceeds(options.max_error)) return {};
  EdgeMarks marks{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = (t[(k + 1) % 3] - t[k]).norm();
    marks[k] = length > options.texels && length >= 0.5 * longest;
  }
  return marks;
}

void check(const Surface& surface, std::span<const FaceUv> uv, const Image& image,
           const ImageOptions& options) {
  check_image("image", image);
  check_uv(surface, uv);
  check_options(options);
}

}  // namespace

Refined refine_image(const Surface& surface, std::span<const FaceUv> uv, const Image& image,
                     const ImageOptions& options, Context* context) {
  check(surface, uv, image, options);
  const Picture picture(image, options.repeat);
  const Chart chart(picture, uv);
  Stretch cutting(context, 0.0, kCut);
  Refined refined = refine(
      surface,
      [&](const Piece& piece) {
        return unresolved_edges(picture, chart.triangle(piece.parent, piece.barycentric), piece,
                                options);
      },
      options.max_faces, cutting.context());
  Stretch filling(context, kCut, kFilled), measuring(context, kFilled, 1.0);
  std::vector<double> density;
  density.reserve(3 * refined.parents.size());
  for (std::size_t f = 0; f < refined.parents.size(); ++f) {
    report_at(filling.context(), f, refined.parents.size());
    const PixelTriangle t = chart.triangle(refined.parents[f], refined.barycentric[f]);
    const Vec3 before = refined.surface.ordered().densities(
        refined.surface.ordered().ordered_face(static_cast<std::int32_t>(f)));
    for (std::size_t k = 0; k < 3; ++k)
      density.push_back(before[static_cast<Eigen::Index>(k)] * picture(t[k]));
  }
  refined.surface =
      refined.surface.with_density({DensityAt::kCorners, density}, measuring.context());
  if (context) context->advance(1.0);
  return refined;
}

}  // namespace dapple
