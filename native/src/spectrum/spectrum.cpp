// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <complex>
#include <dapple/spectrum.hpp>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "spectrum/radial.hpp"

namespace dapple {
namespace {

constexpr double kWidthInUnits = 3.0;  // default half width, in sqrt(n): beyond the second peak
constexpr std::size_t kGrain = 1024;   // points between two checks
constexpr int kWidest = 8192;          // 2 GiB of powers

void check_run(std::size_t run, std::span<const Vec2> points) {
  const std::string name = entry("runs", run);
  if (points.empty()) throw ArgumentError(name + " has no points: at least 1 is needed");
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int axis = 0; axis < 2; ++axis) {
      const double x = points[k][axis];
      if (!std::isfinite(x) || x < 0.0 || x > 1.0)
        throw ArgumentError(entry(name.c_str(), k) + " is not in the unit square: coordinate " +
                            std::to_string(axis) + " is " + number(x));
    }
}

void check_half_width(int half_width) {
  if (half_width < 0 || half_width > kWidest)
    throw ArgumentError("half_width is " + std::to_string(half_width) + ": it must be in 0.." +
                        std::to_string(kWidest));
}

std::size_t largest(std::span<const std::span<const Vec2>> runs) {
  std::size_t count = 0;
  for (const auto& points : runs) count = std::max(count, points.size());
  return count;
}

int chosen_half_width(const SpectrumOptions& options, double unit) {
  if (options.half_width > 0) return options.half_width;
  return std::min(static_cast<int>(std::ceil(kWidthInUnits * unit)), kWidest);
}

/// The angle of exp(-2 pi i cycles) in turns. Only the fraction of a cycle is used, because whole
/// cycles cost digits.
double turns(double cycles) { return std::floor(cycles) - cycles; }

/// exp(-2 pi i (x p_x + y p_y)) of a few points p at once, rotated from one x to the next. The
/// number of points is chosen so that they stay in registers.
class Phases {
 public:
  Phases(std::span<const Vec2> points, int x, int y) {
    for (std::size_t k = 0; k < std::min(points.size(), kPoints); ++k) {
      const auto lane = static_cast<Eigen::Index>(k);
      const Direction start = direction(turns(x * points[k].x()) + turns(y * points[k].y()));
      const Direction turn = direction(turns(points[k].x()));
      real_[lane] = start.cosine;
      imaginary_[lane] = start.sine;
      turn_real_[lane] = turn.cosine;
      turn_imaginary_[lane] = turn.sine;
    }
  }

  [[nodiscard]] std::complex<double> sum() const { return {real_.sum(), imaginary_.sum()}; }

  void next() {
    const Lanes turned = real_ * turn_real_ - imaginary_ * turn_imaginary_;
    imaginary_ = real_ * turn_imaginary_ + imaginary_ * turn_real_;
    real_ = turned;
  }

  static constexpr std::size_t kPoints = 8;

 private:
  using Lanes = Eigen::Array<double, kPoints, 1>;
  Lanes real_ = Lanes::Zero();
  Lanes imaginary_ = Lanes::Zero();
  Lanes turn_real_ = Lanes::Zero();
  Lanes turn_imaginary_ = Lanes::Zero();
};

/// Add `share` of the powers of one run at (-half_width..half_width, y).
void add_row(std::span<const Vec2> points, int half_width, int y, double share,
             std::span<double> row, const Context* context) {
  std::vector<std::complex<double>> sums(row.size());
  for (std::size_t k = 0; k < points.size(); k += Phases::kPoints) {
    if (context && k % kGrain == 0) context->check();
    Phases phases(points.subspan(k), -half_width, y);
    for (std::complex<double>& sum : sums) {
      sum += phases.sum();
      phases.next();
    }
  }
  for (std::size_t x = 0; x < row.size(); ++x)
    row[x] += share * std::norm(sums[x]) / static_cast<double>(points.size());
}

/// Powers at f and -f are equal. The first half is copied from the second, so that both are exactly
/// equal.
void mirror(std::vector<double>& powers) {
  std::copy(powers.rbegin(), powers.rbegin() + static_cast<std::ptrdiff_t>(powers.size() / 2),
            powers.begin());
}

std::vector<double> periodogram(std::span<const std::span<const Vec2>> runs, int half_width,
                                Context* context) {
  const auto half = static_cast<std::size_t>(half_width);
  const std::size_t width = 2 * half + 1;
  std::vector<double> powers(width * width, 0.0);
  std::atomic<std::size_t> done = 0;
  parallel_chunks(half + 1, 1, [&](std::size_t y, std::size_t) {
    if (context) context->check();
    const std::span<double> row = std::span(powers).subspan((half + y) * width, width);
    for (const auto& points : runs)
      add_row(points, half_width, static_cast<int>(y), 1.0 / static_cast<double>(runs.size()), row,
              context);
    if (context) context->advance(static_cast<double>(++done) / static_cast<double>(half + 1));
  });
  mirror(powers);
  return powers;
}

}  // namespace

Spectrum spectrum(std::span<const std::span<const Vec2>> runs, const SpectrumOptions& options,
                  Context* context) {
  if (context) context->check();
  if (runs.empty()) throw ArgumentError("runs is empty: at least one set of points is needed");
  for (std::size_t run = 0; run < runs.size(); ++run) check_run(run, runs[run]);
  check_half_width(options.half_width);
  Spectrum result;
  result.runs = runs.size();
  result.frequency_unit = std::sqrt(static_cast<double>(largest(runs)));
  result.half_width = chosen_half_width(options, result.frequency_unit);
  result.periodogram =
      with_threads(options.threads, [&] { return periodogram(runs, result.half_width, context); });
  result.radial = radial_statistics(result.periodogram, result.half_width, 1.0);
  return result;
}

}  // namespace dapple
