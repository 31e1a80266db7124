// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/stipple.hpp>
#include <numbers>
#include <numeric>

#include "base/allot.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"
#include "sample/timed_call.hpp"
#include "stipple/error_diffusion.hpp"
#include "stipple/raster_domain.hpp"

namespace dapple {
namespace {

constexpr double kDiffused = 0.03;  // share of the progress when the errors are diffused
constexpr double kAlone = 0.25;     // share of the progress when each class is even on its own
constexpr double kRough = 1e-3;     // tolerance of a single class, before all are combined

double sum_of(const Image& image) {
  return std::accumulate(image.values.begin(), image.values.end(), 0.0);
}

std::size_t index(Ink ink) { return static_cast<std::size_t>(ink); }

// ---- checks ----

std::string name_of(std::size_t ink) { return "inks[" + std::to_string(ink) + "]"; }

void check_shape(const std::string& name, const Image& image, const Image& first) {
  if (image.rows != first.rows || image.columns != first.columns)
    throw ArgumentError(name + " has " + std::to_string(image.rows) + " x " +
                        std::to_string(image.columns) + " pixels and the first " +
                        std::to_string(first.rows) + " x " + std::to_string(first.columns) +
                        ": all must be of one shape");
}

/// Like check_image(), but an ink may be absent.
void check_ink(const std::string& name, const Image& image) {
  if (image.values.size() == image.rows * image.columns && !image.values.empty() &&
      std::all_of(image.values.begin(), image.values.end(), [](double v) { return v == 0.0; }))
    return;
  check_image(name.c_str(), image);
}

void check(std::span<const Image> inks, std::size_t count, const StippleOptions& options) {
  if (inks.empty()) throw ArgumentError("inks is empty: at least one is needed");
  if (count == 0) throw ArgumentError("count is 0: it must be at least 1");
  check_count("count", count);
  check_options(options);
  double ink = 0.0;
  for (std::size_t c = 0; c < inks.size(); ++c) {
    check_ink(name_of(c), inks[c]);
    check_shape(name_of(c), inks[c], inks[0]);
    ink += sum_of(inks[c]);
  }
  if (!(ink > 0.0)) throw ArgumentError("the picture is white everywhere: no dots can be placed");
}

void check_counts(std::span<const Image> inks, std::size_t count,
                  std::span<const std::size_t> counts) {
  check_same_length("counts", counts.size(), "inks", inks.size());
  for (std::size_t c = 0; c < counts.size(); ++c) check_count(entry("counts", c), counts[c]);
  const std::size_t sum = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  if (sum != count)
    throw ArgumentError("counts sum to " + std::to_string(sum) + ", and count is " +
                        std::to_string(count) + ": they must be the same");
  for (std::size_t c = 0; c < counts.size(); ++c)
    if (counts[c] > 0 && !(sum_of(inks[c]) > 0.0))
      throw ArgumentError(entry("counts", c) + " is " + std::to_string(counts[c]) +
                          ", but the picture does not contain this ink");
}

// ---- the problem ----

std::vector<double> sums_of(std::span<const Image> inks) {
  std::vector<double> sums;
  for (const Image& ink : inks) sums.push_back(sum_of(ink));
  return sums;
}

/// The sum of the coverages, each scaled to its number of dots.
Image union_of(std::span<const Image> inks, std::span<const std::size_t> counts) {
  Image all = {inks[0].rows, inks[0].columns, std::vector<double>(inks[0].values.size(), 0.0)};
  for (std::size_t c = 0; c < inks.size(); ++c) {
    if (counts[c] == 0) continue;
    const double scale = static_cast<double>(counts[c]) / sum_of(inks[c]);
    for (std::size_t k = 0; k < all.values.size(); ++k) all.values[k] += scale * inks[c].values[k];
  }
  return all;
}

ClassProblem to_problem(std::span<const Image> inks, std::span<const std::size_t> counts) {
  ClassProblem problem;
  problem.all = std::make_shared<RasterDomain>(union_of(inks, counts));
  const bool one = std::count(counts.begin(), counts.end(), std::size_t{0}) + 1 ==
                   static_cast<std::ptrdiff_t>(counts.size());
  for (std::size_t c = 0; c < inks.size(); ++c)
    problem.classes.push_back(
        {one || counts[c] == 0 ? problem.all : std::make_shared<const RasterDomain>(inks[c]),
         counts[c]});
  return problem;
}

/// Move each dot to the nearest pixel with its ink, class by class.
Sites to_sites(const ClassProblem& problem, const Diffused& dots) {
  Sites sites;
  for (std::size_t c = 0; c < problem.classes.size(); ++c) {
    std::vector<Vec3> mine;
    for (std::size_t k = 0; k < dots.classes.size(); ++k)
      if (dots.classes[k] == static_cast<std::int32_t>(c))
        mine.emplace_back(dots.positions[k].x(), dots.positions[k].y(), 0.0);
    const Sites found = problem.classes[c].domain->project(mine, {});
    sites.positions.insert(sites.positions.end(), found.positions.begin(), found.positions.end());
    sites.faces.insert(sites.faces.end(), found.faces.begin(), found.faces.end());
  }
  sites.barycentric.assign(sites.size(), Vec3::Zero());
  return sites;
}

double radius_of(std::span<const Image> inks, std::size_t count) {
  double covered = 0.0;
  for (const Image& ink : inks) covered += sum_of(ink);
  return std::sqrt(covered / (std::numbers::pi * static_cast<double>(count)));
}

/// Options for optimizing each class alone, with a larger tolerance because the other classes move
/// it again.
ClassOptions rough(ClassOptions options) {
  double& tolerance = options.sample.optimizer.tolerance;
  tolerance = std::max(tolerance, kRough);
  return options;
}

/// The weight of a class is its number of dots. Thus all dots have equal weight, and the few dots
/// of a rare ink adapt to the many others.
Objective to_objective(const ClassProblem& problem, const ClassOptions& options) {
  Objective objective = make_objective(problem, class_of_sites(problem), options);
  const auto classes = static_cast<double>(objective.terms.size() - 1);
  const auto dots = static_cast<double>(objective.classes.size());
  for (std::size_t t = 1; t < objective.terms.size(); ++t)
    objective.terms[t].weight =
        classes * static_cast<double>(objective.terms[t].members.size()) / dots;
  return objective;
}

Stipples solve_stipple(std::span<const Image> inks, std::span<const std::size_t> counts,
                       const StippleOptions& options, Context* context) {
  const ClassProblem problem = to_problem(inks, counts);
  Sites start = in_stage(context, Stage::kStart, [&] {
    return to_sites(problem, diffuse_errors(inks, counts, options.seed, context));
  });
  if (context) context->advance(kDiffused);
  ClassOptions chosen;
  chosen.sample.optimizer = options.optimizer;
  chosen.union_weight = options.union_weight;
  const Objective objective = to_objective(problem, chosen);
  Minimum before;
  const bool many = objective.terms.size() > 1;
  const double together = many ? kAlone : kDiffused;
  Stretch alone(context, kDiffused, together);
  Stretch finishing(context, together, 1.0);
  if (many) settle_alone(problem, rough(chosen), start, before, alone.context());
  ClassMinimum found = solve(objective, start, options.optimizer, finishing.context());
  found.minimum.count(before);
  const StageSpan reporting(context, Stage::kReporting);
  Stipples result;
  for (const Vec3& x : found.minimum.state.sites.positions)
    result.positions.emplace_back(x.head<2>());
  result.classes = found.objective.classes;
  result.report = to_report(found.objective, found.minimum, inks.size(),
                            std::vector<Vec3>(result.positions.size(), Vec3::UnitZ()));
  return result;
}

}  // namespace

Stipples stipple_inks(std::span<const Image> inks, std::size_t count, const StippleOptions& options,
                      Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check(inks, count, options);
  const std::vector<std::size_t> counts =
      options.counts.empty() ? allot(sums_of(inks), count) : options.counts;
  check_counts(inks, count, counts);
  Stipples result = with_threads(
      options.threads, [&] { return solve_stipple(inks, counts, options, call.context()); });
  result.radius = options.radius > 0.0 ? options.radius : radius_of(inks, count);
  call.write(result.report);
  if (context) context->advance(1.0);
  return result;
}

// ---- color ----

std::array<Image, kInks> separate_inks(const ColorImage& picture) {
  constexpr std::array<const char*, 3> kNames = {"red", "green", "blue"};
  // The ink that two of the three process colors make, and the remaining process color.
  constexpr std::array<Ink, 3> kWithout = {Ink::kRed, Ink::kGreen, Ink::kBlue};
  constexpr std::array<Ink, 3> kLeftAlone = {Ink::kCyan, Ink::kMagenta, Ink::kYellow};
  for (std::size_t k = 0; k < 3; ++k) {
    check_shape(kNames[k], picture[k], picture[0]);
    check_same_length(kNames[k], picture[k].values.size(), "its pixels",
                      picture[k].rows * picture[k].columns);
    for (std::size_t p = 0; p < picture[k].values.size(); ++p) {
      check_at(p);
      if (!(picture[k].values[p] >= 0.0 && picture[k].values[p] <= 1.0))
        throw ArgumentError(entry(kNames[k], p) + " is " + number(picture[k].values[p]) +
                            ": it must be in [0, 1]");
    }
  }
  std::array<Image, kInks> inks;
  for (Image& ink : inks)
    ink = {picture[0].rows, picture[0].columns, std::vector<double>(picture[0].values.size(), 0.0)};
  for (std::size_t p = 0; p < picture[0].values.size(); ++p) {
    check_at(p);
    std::array<std::size_t, 3> order = {0, 1, 2};
    const auto covers = [&](std::size_t k) { return 1.0 - picture[k].values[p]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return covers(a) != covers(b) ? covers(a) < covers(b) : a < b;
    });
    const auto [least, middle, most] = order;
    inks[index(Ink::kBlack)].values[p] = covers(least);
    inks[index(kWithout[least])].values[p] = covers(middle) - covers(least);
    inks[index(kLeftAlone[most])].values[p] = covers(most) - covers(middle);
  }
  return inks;
}

ColorImage mix_inks(const std::array<Image, kInks>& inks) {
  // The light that each ink absorbs: red, green and blue.
  constexpr std::array<std::array<double, 3>, kInks> kTakes = {
      {{0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}};
  ColorImage picture;
  for (std::size_t k = 0; k < 3; ++k) {
    picture[k] = {inks[0].rows, inks[0].columns, std::vector<double>(inks[0].values.size(), 1.0)};
    for (std::size_t c = 0; c < kInks; ++c)
      for (std::size_t p = 0; p < picture[k].values.size(); ++p)
        check_at(p), picture[k].values[p] -= kTakes[c][k] * inks[c].values[p];
  }
  return picture;
}

}  // namespace dapple
