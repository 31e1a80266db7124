// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <dapple/spectrum.hpp>
#include <numbers>
#include <optional>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/validate_samples.hpp"
#include "spectrum/radial.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 64;
constexpr double kSites = 2.0 / std::numbers::sqrt3;  // number of sites in a squared spacing
constexpr double kBorderStep = 0.1;  // distance between points that represent a border, in spacings
constexpr double kFarthest = 3.0;    // frequency, in sqrt(n / A)
constexpr double kSameSlope = 1e-6;  // c_p = c_q up to rounding: the limit of the formula is used
constexpr double kLargestRadius = 100.0;
constexpr int kMostBins = 4096;
constexpr double kGathered = 0.8;  // share of the progress when all pairs are counted

/// Euclidean distance corrected for the curvature that the normals indicate (Bowers et al. 2010,
/// section 3.2); none if p and q face away from each other.
std::optional<double> geodesic(double distance, double slope_p, double slope_q) {
  const double p = std::clamp(slope_p, -1.0, 1.0);
  const double q = std::clamp(slope_q, -1.0, 1.0);
  const double middle = 0.5 * (p + q);
  const double stretch = std::abs(p - q) < kSameSlope ? 1.0 / std::sqrt(1.0 - middle * middle)
                                                      : (arc_sine(p) - arc_sine(q)) / (p - q);
  if (!std::isfinite(stretch)) return std::nullopt;
  return distance * stretch;
}

/// Tangent plane with axes from the projection of the world's x axis, or of z if x is normal to the
/// plane.
struct Frame {
  Vec3 x, y;

  explicit Frame(const Vec3& normal) {
    Vec3 along = Vec3::UnitX() - normal.x() * normal;
    if (along.squaredNorm() < 1e-12) along = Vec3::UnitZ() - normal.z() * normal;
    x = along.normalized();
    y = normal.cross(x);
  }

  /// The vector of the given length in the direction of `v` in the plane.
  [[nodiscard]] Vec2 project(const Vec3& v, double length) const {
    const Vec2 flat(v.dot(x), v.dot(y));
    const double norm = flat.norm();
    return norm > 0.0 ? Vec2(length / norm * flat) : Vec2(Vec2::Zero());
  }
};

/// Points along the border edges, at most `step` apart.
std::vector<Vec3> border_points(const Surface& surface, double step) {
  std::vector<Vec3> points;
  const auto half_edges = static_cast<std::int32_t>(3 * surface.face_count());
  for (std::int32_t h = 0; h < half_edges; ++h) {
    if (!surface.ordered().is_border(h)) continue;
    const Face& corners = surface.ordered().corners(face_of(h));
    const Vec3& a = surface.ordered().vertex(corners[static_cast<std::size_t>(h % 3)]);
    const Vec3& b = surface.ordered().vertex(corners[static_cast<std::size_t>((h + 1) % 3)]);
    const int pieces = 1 + static_cast<int>((b - a).norm() / step);
    for (int k = 0; k < pieces; ++k) points.emplace_back(a + (k + 0.5) / pieces * (b - a));
  }
  return points;
}

/// Integer counts, whose sums do not depend on the order.
using Counts = std::vector<std::uint64_t>;

/// The differentials of one set of samples.
class Differentials {
 public:
  Differentials(const Surface& surface, const Samples& samples, double radius, int bins,
                const Context* context)
      : surface_(surface),
        samples_(samples),
        tree_(samples.positions),
        radius_(radius),
        width_(2.0 * radius / bins),
        reach_(radius + width_),
        bins_(bins) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      spacings_.push_back(local_spacing(k));
      frames_.emplace_back(samples.normals[k]);
    }
    find_centers(context);
  }

  [[nodiscard]] std::size_t centers() const { return centers_; }

  /// The expected number of differentials per center and bin for white noise.
  [[nodiscard]] double expected() const {
    const auto count = static_cast<double>(samples_.size());
    return kSites * (count - 1.0) / count * width_ * width_;
  }

  /// Count the pairs whose larger spacing is that of sample i (of the lower index if equal).
  void count_pairs(std::size_t i, std::vector<Neighbor>& found, Counts& counts) const {
    if (!std::isfinite(spacings_[i])) return;
    find_near(i, found);
    for (const Neighbor& near : found) {
      const auto j = static_cast<std::size_t>(near.index);
      if (spacings_[j] < spacings_[i] || (spacings_[j] == spacings_[i] && i < j))
        count_pair(i, j, counts);
    }
  }

 private:
  [[nodiscard]] double local_spacing(std::size_t sample) const {
    const double uniform = surface_.spacing(samples_.size());
    if (surface_.uniform()) return uniform;
    const double density = samples_.barycentric[sample].dot(
        surface_.ordered().densities(surface_.ordered().ordered_face(samples_.faces[sample])));
    return uniform * std::sqrt(surface_.capacity() / surface_.area() / density);
  }

  void find_centers(const Context* context) {
    const double step = kBorderStep * surface_.spacing(samples_.size());
    const std::vector<Vec3> border = border_points(surface_, step);
    const Neighbors tree(border);
    std::vector<Neighbor> nearest;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      if (context && k % kGrain == 0) context->check();
      bool inside = std::isfinite(spacings_[k]);
      if (inside && !border.empty()) {
        tree.nearest(samples_.positions[k], 1, nearest);
        inside = std::sqrt(nearest[0].squared_distance) > reach_ * spacings_[k] + 0.5 * step;
      }
      is_center_.push_back(inside);
      centers_ += inside ? 1 : 0;
    }
  }

  /// All samples within reach of sample i, and perhaps more.
  void find_near(std::size_t i, std::vector<Neighbor>& found) const {
    const double limit = reach_ * spacings_[i];
    auto count = 16 + static_cast<std::size_t>(1.3 * std::numbers::pi * kSites * reach_ * reach_);
    do {
      count = std::min(count, samples_.size());
      tree_.nearest(samples_.positions[i], count, found);
      count *= 2;
    } while (found.size() < samples_.size() && found.back().squared_distance < limit * limit);
  }

  void count_pair(std::size_t i, std::size_t j, Counts& counts) const {
    const Vec3& n_i = samples_.normals[i];
    const Vec3& n_j = samples_.normals[j];
    if (n_i.dot(n_j) <= 0.0) return;
    const Vec3 v = samples_.positions[j] - samples_.positions[i];
    const double distance = v.norm();
    const double unit = distance > 0.0 ? 1.0 / distance : 0.0;
    const auto length = geodesic(distance, unit * n_i.dot(v), unit * n_j.dot(v));
    if (!length) return;
    const double scaled = *length / (0.5 * (spacings_[i] + spacings_[j]));
    if (is_center_[i]) count(frames_[i].project(v, scaled), counts);
    if (is_center_[j]) count(frames_[j].project(-v, scaled), counts);
  }

  void count(const Vec2& differential, Counts& counts) const {
    const Vec2 at = (differential.array() + radius_) / width_;
    if (!(at.minCoeff() >= 0.0 && at.maxCoeff() < bins_)) return;
    ++counts[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(bins_) +
             static_cast<std::size_t>(at.x())];
  }

  const Surface& surface_;
  const Samples& samples_;
  Neighbors tree_;
  double radius_;
  double width_;
  double reach_;  // a bin farther than the radius, so that all bins are complete up to there
  int bins_;
  std::vector<double> spacings_;  // infinite where the density is 0
  std::vector<Frame> frames_;
  std::vector<bool> is_center_;
  std::size_t centers_ = 0;
};

void check_options(const SurfaceSpectrumOptions& options) {
  if (!(options.radius > 0.0 && options.radius <= kLargestRadius))
    throw ArgumentError("radius is " + number(options.radius) + ": it must be in (0, " +
                        number(kLargestRadius) + "] spacings");
  if (options.bins < 2 || options.bins > kMostBins || options.bins % 2 != 0)
    throw ArgumentError("bins is " + std::to_string(options.bins) + ": it must be even, in 2.." +
                        std::to_string(kMostBins));
}

void check_runs(const Surface& surface, std::span<const Samples* const> runs) {
  if (runs.empty()) throw ArgumentError("runs is empty: at least one set of samples is needed");
  for (std::size_t run = 0; run < runs.size(); ++run) {
    if (runs[run]->size() < 2)
      throw ArgumentError(entry("runs", run) + " has " + std::to_string(runs[run]->size()) +
                          " samples: at least 2 are needed");
    check_samples(surface, *runs[run], entry("runs", run));
  }
}

/// Adds up the counts of the runs.
class Gathering {
 public:
  Gathering(const SurfaceSpectrumOptions& options, std::size_t runs, Context* context)
      : options_(options),
        runs_(runs),
        context_(context),
        total_(static_cast<std::size_t>(options.bins) * static_cast<std::size_t>(options.bins)) {}

  void add(const Surface& surface, const Samples& samples) {
    const Differentials run(surface, samples, options_.radius, options_.bins, context_);
    tbb::enumerable_thread_specific<Counts> counts(Counts(total_.size(), 0));
    std::atomic<std::size_t> done = 0;
    parallel_chunks(samples.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      if (context_) context_->check();
      std::vector<Neighbor> found;
      Counts& mine = counts.local();
      for (std::size_t i = begin; i < end; ++i) run.count_pairs(i, found, mine);
      advance(done += end - begin, samples.size());
    });
    for (const Counts& part : counts)
      for (std::size_t k = 0; k < total_.size(); ++k) total_[k] += part[k];
    centers_ += run.centers();
    expected_ += static_cast<double>(run.centers()) * run.expected();
    ++added_;
  }

  [[nodiscard]] std::size_t centers() const { return centers_; }

  /// The ratios of found and expected counts, equal at d and -d.
  [[nodiscard]] std::vector<double> ratios() const {
    std::vector<double> result;
    for (std::size_t k = 0; k < total_.size(); ++k)
      result.push_back(0.5 * static_cast<double>(total_[k] + total_[total_.size() - 1 - k]) /
                       expected_);
    return result;
  }

 private:
  void advance(std::size_t done, std::size_t of) const {
    const double here = static_cast<double>(done) / static_cast<double>(of);
    if (context_)
      context_->advance((static_cast<double>(added_) + here) / static_cast<double>(runs_));
  }

  SurfaceSpectrumOptions options_;
  std::size_t runs_;
  Context* context_;
  Counts total_;
  std::size_t added_ = 0;
  std::size_t centers_ = 0;
  double expected_ = 0.0;
};

/// Bins on a square around the origin.
struct Bins {
  int count;
  double width;

  [[nodiscard]] double middle(int k) const { return (k + 0.5 - 0.5 * count) * width; }
  [[nodiscard]] double distance(int x, int y) const {
    return std::sqrt(middle(x) * middle(x) + middle(y) * middle(y));
  }
};

/// Radial statistics over one of each pair d, -d.
RadialStatistics radial_differentials(const std::vector<double>& ratios, const Bins& bins) {
  Annuli annuli(static_cast<std::size_t>(bins.count / 2));
  auto ratio = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  for (int y = bins.count / 2; y < bins.count; ++y)
    for (int x = 0; x < bins.count; ++x, ++ratio)
      annuli.add(static_cast<std::size_t>(bins.distance(x, y) / bins.width), *ratio);
  return annuli.statistics(0.5, bins.width);
}

using Row = Eigen::RowVectorXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The function to transform: ratio - 1, faded out toward the radius, because a sharp end would
/// cause ringing.
Rows faded(const std::vector<double>& ratios, const Bins& bins, double radius) {
  Rows result(bins.count, bins.count);
  auto ratio = ratios.begin();
  for (int y = 0; y < bins.count; ++y)
    for (int x = 0; x < bins.count; ++x, ++ratio) {
      const double r = bins.distance(x, y);
      const double fade = r < radius ? direction(0.25 * r / radius).cosine : 0.0;
      result(y, x) = (*ratio - 1.0) * fade * fade;
    }
  return result;
}

/// A matrix product whose sums are computed in a fixed order, because Eigen's products choose an
/// order by the processor's caches.
Row product(const Row& left, const Rows& right) {
  Row sum = Row::Zero(right.cols());
  for (Eigen::Index k = 0; k < right.rows(); ++k) sum += left[k] * right.row(k);
  return sum;
}

/// Cosines and sines of an axis: a row for each bin, a column for each frequency.
struct Waves {
  Rows cosines, sines;

  Waves(const Bins& bins, int half_width, double step)
      : cosines(bins.count, 2 * half_width + 1), sines(bins.count, 2 * half_width + 1) {
    for (int k = 0; k < bins.count; ++k)
      for (int f = -half_width; f <= half_width; ++f) {
        const auto [cosine, sine] = direction(f * step * bins.middle(k));
        cosines(k, f + half_width) = cosine;
        sines(k, f + half_width) = sine;
      }
  }
};

/// 1 + number of sites in a squared spacing * Fourier transform; `step` in cycles per spacing.
/// Values that are equal at d and -d have a real transform: cos x cos y - sin x sin y, computed one
/// axis at a time.
std::vector<double> transformed(const Rows& values, const Bins& bins, int half_width, double step,
                                Context* context) {
  const Waves waves(bins, half_width, step);
  const Eigen::Index size = waves.cosines.cols();
  const double area = kSites * bins.width * bins.width;
  std::vector<double> result;
  for (Eigen::Index y = 0; y < size; ++y) {
    if (context) context->check();
    const Row sums = product(product(waves.cosines.col(y).transpose(), values), waves.cosines) -
                     product(product(waves.sines.col(y).transpose(), values), waves.sines);
    for (const double sum : sums) result.push_back(1.0 + area * sum);
    if (context) context->advance(static_cast<double>(y + 1) / static_cast<double>(size));
  }
  return result;
}

void blank_corners(std::vector<double>& ratios, const Bins& bins, double radius) {
  auto ratio = ratios.begin();
  for (int y = 0; y < bins.count; ++y)
    for (int x = 0; x < bins.count; ++x, ++ratio)
      if (bins.distance(x, y) >= radius) *ratio = std::numeric_limits<double>::quiet_NaN();
}

void finish(SurfaceSpectrum& result, Context* context) {
  const Bins bins{result.bins, 2.0 * result.radius / result.bins};
  result.radial_differentials = radial_differentials(result.differentials, bins);
  const double step = 0.5 / result.radius;  // the resolution of the neighborhood
  const double unit = std::sqrt(kSites);    // spacing * sqrt(n / A)
  result.frequency_step = step / unit;
  result.half_width =
      std::min(static_cast<int>(std::ceil(kFarthest / result.frequency_step)), result.bins / 2);
  result.power = transformed(faded(result.differentials, bins, result.radius), bins,
                             result.half_width, step, context);
  result.radial_power = radial_statistics(result.power, result.half_width, result.frequency_step);
  blank_corners(result.differentials, bins, result.radius);
}

}  // namespace

SurfaceSpectrum surface_spectrum(const Surface& surface, std::span<const Samples* const> runs,
                                 const SurfaceSpectrumOptions& options, Context* context) {
  check_options(options);
  check_runs(surface, runs);
  if (context) context->check();
  Stretch counting(context, 0.0, kGathered), finishing(context, kGathered, 1.0);
  Gathering gathering(options, runs.size(), counting.context());
  with_threads(options.threads, [&] {
    for (const Samples* samples : runs) gathering.add(surface, *samples);
  });
  if (gathering.centers() == 0)
    throw ArgumentError("radius is " + number(options.radius) +
                        " spacings: no sample is that far from the border");
  SurfaceSpectrum result;
  result.runs = runs.size();
  result.centers = gathering.centers();
  result.radius = options.radius;
  result.bins = options.bins;
  result.differentials = gathering.ratios();
  finish(result, finishing.context());
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
