// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/symmetric_samples.hpp>
#include <numeric>
#include <optional>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "optimize/mirror.hpp"
#include "rebalance/widest_gaps.hpp"
#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"
#include "sample/surface_classes.hpp"
#include "sample/symmetric_ground.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kSolved = 0.6;  // of the progress, when the samples are not yet symmetric
// Samples nearer to the plane move onto it, in local spacings. A strip of twice that holds one
// sample each sqrt(3) spacings of its length; so does a mirror line of the hexagonal lattice that
// is not along its rows.
constexpr double kStrip = 0.25;
constexpr double kFarthest = 1.0;   // that any sample moves to the plane, in local spacings
constexpr double kPerSample = 0.1;  // as much as a sample too many or too few: width of the strip
constexpr int kSteps = 8;           // of Newton's method to the plane
constexpr double kArrived = 1e-9;   // local spacings from the plane

/// Samples that could be on the plane, the nearest first.
struct NearPlane {
  std::vector<std::int32_t> sites;
  std::vector<double> distances;  ///< along the surface, in local spacings
  Sites on_plane;                 ///< where they are then
};

/// One half, and how many samples of NearPlane are on the plane.
struct Choice {
  std::size_t on_plane = 0;
  double side = 1.0;         ///< of the plane, whose samples are mirrored
  std::ptrdiff_t count = 0;  ///< samples, with images
};

Mirror mirror_of(const SymmetryOptions& options) {
  check_finite("normal", {&options.normal, 1});
  check_finite("point", {&options.point, 1});
  const double length = options.normal.stableNorm();
  if (!(length > 0.0)) throw ArgumentError("normal is (0, 0, 0): it must have a length");
  Mirror mirror;
  mirror.point = options.point;
  mirror.normal = (options.normal / length).stableNormalized();
  return mirror;
}

/// Where edges of faces with density cross the plane.
Sites crossings(const Surface& surface, const Mirror& mirror) {
  const OrderedSurface& ordered = surface.ordered();
  Sites result;
  for (std::size_t k = 0; k < 3 * surface.face_count(); ++k) {
    const auto f = static_cast<std::int32_t>(k / 3);
    const OrderedFace face = ordered.ordered_face(f);
    if (!ordered.counts(face) || !(ordered.geometry(face).moments.capacity > 0.0)) continue;
    const auto from = static_cast<Eigen::Index>(k % 3), to = (from + 1) % 3;
    const double before = mirror.height(surface.point(f, Vec3::Unit(from)));
    const double after = mirror.height(surface.point(f, Vec3::Unit(to)));
    if (before == after || (before > 0.0) == (after > 0.0)) continue;
    const double share = before / (before - after);
    const Vec3 weights = (1.0 - share) * Vec3::Unit(from) + share * Vec3::Unit(to);
    append(result, {{surface.point(f, weights)}, {f}, {weights}});
  }
  return result;
}

/// If no sample comes to the plane along the surface: the sample nearest to it, at the plane.
NearPlane nearest_to_plane(const ClassMinimum& found, const Surface& surface,
                           const Mirror& mirror) {
  const Sites& sites = found.minimum.state.sites;
  const Sites places = crossings(surface, mirror);
  if (places.size() == 0) return {};
  const Neighbors tree(places.positions);
  std::vector<Neighbor> near;
  NearPlane result;
  double least = kInfinite;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    tree.nearest(sites.positions[k], 1, near);
    const double distance = (places.positions[as_index(near[0].index)] - sites.positions[k]).norm();
    if (!(distance < least)) continue;
    least = distance;
    const double spacing = local_spacing(found.objective, found.minimum.state, 0, k);
    result = {{static_cast<std::int32_t>(k)}, {distance / spacing}, {}};
    result.on_plane = select(places, std::array{near[0].index});
  }
  return result;
}

NearPlane near_plane(const ClassMinimum& found, const Mirror& mirror, const Context* context) {
  const Objective& objective = found.objective;
  const Sites& sites = found.minimum.state.sites;
  std::vector<std::int32_t> close;
  std::vector<double> spacings;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const double spacing = local_spacing(objective, found.minimum.state, 0, k);
    if (!(std::abs(mirror.height(sites.positions[k])) < kFarthest * spacing)) continue;
    close.push_back(static_cast<std::int32_t>(k));
    spacings.push_back(spacing);
  }
  const Sites from = select(sites, close);
  const Sites to = led_to_plane(objective.domain(), mirror, from, kSteps, context);
  std::vector<double> distances(close.size());
  std::vector<std::int32_t> order;
  for (std::size_t k = 0; k < close.size(); ++k) {
    distances[k] = (to.positions[k] - from.positions[k]).norm() / spacings[k];
    if (distances[k] < kFarthest &&
        std::abs(mirror.height(to.positions[k])) <= kArrived * spacings[k])
      order.push_back(static_cast<std::int32_t>(k));
  }
  std::ranges::stable_sort(order, {}, [&](std::int32_t k) { return distances[as_index(k)]; });
  NearPlane result{{}, {}, select(to, order)};
  for (const std::int32_t k : order) {
    result.sites.push_back(close[as_index(k)]);
    result.distances.push_back(distances[as_index(k)]);
  }
  return result;
}

/// The half and the strip with which the number of samples is right, or nearly so, and of which the
/// strip is about as wide as it should be. Pairs make up for an even difference.
/// \throw ArgumentError if all differences are odd
Choice choose(const Sites& sites, const NearPlane& near, const Mirror& mirror) {
  const auto count = static_cast<std::ptrdiff_t>(sites.size());
  std::optional<Choice> best;
  double least = kInfinite;
  for (const double side : {1.0, -1.0}) {
    const auto is_here = [&](const Vec3& p) { return side * mirror.height(p) > 0.0; };
    auto pairs = static_cast<std::ptrdiff_t>(std::ranges::count_if(sites.positions, is_here));
    for (std::size_t k = 0; k <= near.sites.size(); ++k) {
      if (k > 0 && is_here(sites.positions[as_index(near.sites[k - 1])])) --pairs;
      const std::ptrdiff_t total = 2 * pairs + static_cast<std::ptrdiff_t>(k);
      const std::ptrdiff_t off = std::abs(count - total);
      const double from = k > 0 ? near.distances[k - 1] : 0.0;
      const double to = k < near.sites.size() ? near.distances[k] : kInfinite;
      const double cost =
          kPerSample * static_cast<double>(off) + std::max({0.0, from - kStrip, kStrip - to});
      if (off % 2 == 1 || (total == 0 && count > 0) || !(cost < least)) continue;
      least = cost;
      best = {k, side, total};
    }
  }
  if (!best)
    throw ArgumentError(
        "count is " + std::to_string(count) +
        ": it must be even, because the surface does not cross the plane of symmetry");
  return *best;
}

/// The sites of one half, without those with the smallest cells if there are too many.
Sites half_of(const Evaluation& state, const NearPlane& near, const Choice& choice,
              const Mirror& mirror) {
  std::vector<bool> taken(state.sites.size(), false);
  for (std::size_t k = 0; k < choice.on_plane; ++k) taken[as_index(near.sites[k])] = true;
  std::vector<std::int32_t> half;
  for (std::size_t k = 0; k < taken.size(); ++k)
    if (!taken[k] && choice.side * mirror.height(state.sites.positions[k]) > 0.0)
      half.push_back(static_cast<std::int32_t>(k));
  const std::ptrdiff_t too_many =
      (choice.count - static_cast<std::ptrdiff_t>(state.sites.size())) / 2;
  if (too_many > 0) {
    std::ranges::stable_sort(half, std::greater{}, [&](std::int32_t k) {
      return state.diagram().cells[as_index(k)].capacity;
    });
    half.resize(half.size() - static_cast<std::size_t>(too_many));
    std::ranges::sort(half);
  }
  return select(state.sites, half);
}

/// Sites in the order of SymmetricSamples, and their partners.
Sites with_images(const Domain& domain, Mirror& mirror, const Sites& half, const Sites& on_plane,
                  const Context* context) {
  const Sites images = mirror.images(domain, half, {}, context);
  Sites sites;
  mirror.partners.clear();
  for (std::size_t k = 0; k < half.size(); ++k) {
    const bool ahead = mirror.height(half.positions[k]) > 0.0;
    for (const Sites* of : {ahead ? &half : &images, ahead ? &images : &half}) {
      sites.positions.push_back(of->positions[k]);
      sites.faces.push_back(of->faces[k]);
      sites.barycentric.push_back(of->barycentric[k]);
    }
    const auto first = static_cast<std::int32_t>(2 * k);
    mirror.partners.insert(mirror.partners.end(), {first + 1, first});
  }
  append(sites, on_plane);
  for (std::size_t k = mirror.partners.size(); k < sites.size(); ++k)
    mirror.partners.push_back(static_cast<std::int32_t>(k));
  return sites;
}

/// The samples made symmetric. Where there are too few, pairs come into the widest gaps.
Sites symmetric_start(const Surface& surface, const ClassMinimum& found, Mirror& mirror,
                      std::uint64_t seed, const Context* context) {
  const Evaluation& state = found.minimum.state;
  const Domain& domain = found.objective.domain();
  const std::size_t count = state.sites.size();
  NearPlane near = near_plane(found, mirror, context);
  if (near.sites.empty()) near = nearest_to_plane(found, surface, mirror);
  const Choice choice = choose(state.sites, near, mirror);
  std::vector<std::int32_t> first(choice.on_plane);
  std::iota(first.begin(), first.end(), 0);
  const Sites on_plane = select(near.on_plane, first);
  Sites half = half_of(state, near, choice, mirror);
  Sites sites = with_images(domain, mirror, half, on_plane, context);
  while (sites.size() < count) {
    const Gaps gaps{sites, std::vector<bool>(sites.size(), true),
                    domain.capacity() / static_cast<double>(count)};
    const Sites fresh = widest_gaps(domain.sampling_surface(count), gaps, 1, seed, context);
    if (fresh.size() == 0)
      throw ArgumentError("count is " + std::to_string(count) + ", but there are places for only " +
                          std::to_string(sites.size()) + " samples");
    append(half, fresh);
    sites = with_images(domain, mirror, half, on_plane, context);
  }
  return sites;
}

double largest_error(const Mirror& mirror, std::span<const Vec3> positions) {
  double most = 0.0;
  for (std::size_t k = 0; k < positions.size(); ++k)
    most = std::max(
        most, (mirror.reflected(positions[k]) - positions[as_index(mirror.partners[k])]).norm());
  return most;
}

/// Minimize among symmetric configurations, on from a solution without symmetry.
void make_symmetric(const Surface& surface, ClassMinimum& found, Mirror& mirror,
                    const SampleOptions& options, Context* context) {
  const Sites start = symmetric_start(surface, found, mirror, options.seed, context);
  OptimizerOptions rest = options.optimizer;
  rest.max_evaluations = std::max(1, rest.max_evaluations - found.minimum.evaluations);
  found.objective.mirror = &mirror;
  Minimum next = minimize(found.objective, start, rest, context);
  next.count(found.minimum);
  found.minimum = std::move(next);
}

}  // namespace

SymmetricSamples sample_symmetric(const Surface& surface, std::size_t count,
                                  const SymmetryOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check_options(options);
  check_none_locked("sample.locked", options.sample.locked,
                    "a locked sample has no mirror image that is locked too");
  Mirror mirror = mirror_of(options);
  SymmetricSamples result = with_threads(options.sample.threads, [&] {
    const SymmetricGround ground =
        symmetric_ground(surface, mirror, options.max_mirror_error, call.context());
    mirror.farthest = ground.farthest;
    const SampleClass all{.count = count};
    const ClassProblem problem = surface_classes(ground.surface, {&all, 1}, options.sample.cells);
    Stretch solving(call.context(), 0.0, kSolved), pairing(call.context(), kSolved, 1.0);
    ClassMinimum found = solve(problem, options_of_one(options.sample), solving.context());
    if (count > 0) make_symmetric(ground.surface, found, mirror, options.sample, pairing.context());
    const StageSpan reporting(call.context(), Stage::kReporting);
    Samples samples = to_samples(ground.surface, found.objective, found.minimum, 1);
    const double error = largest_error(mirror, samples.positions);
    return SymmetricSamples{std::move(samples), mirror.partners, error};
  });
  call.write(result.samples.report);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
