// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/population.hpp>
#include <dapple/resample.hpp>
#include <map>
#include <set>

#include "base/progress.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

// Of one sample: the surface must ask for that much more than the nearest whole number before the
// number changes, or a breathing body would let the same one come and go.
constexpr double kReluctance = 0.75;

void check_wanted(double wanted, std::size_t now) {
  if (!(wanted <= static_cast<double>(kMostSamples)))
    throw ArgumentError("vertices span a surface that asks for " + number(wanted) +
                        " samples instead of " + std::to_string(now) + ": at most " +
                        std::to_string(kMostSamples) + " are possible");
}

}  // namespace

Population::Population(Surface surface, Samples samples, PopulationOptions options,
                       Context* context)
    : tracker_(std::move(surface), std::move(samples), options.tracker, {}, context),
      options_(options),
      next_id_(0) {
  check_options(options);
  const Samples& first = tracker_.samples();
  density_ = static_cast<double>(first.size()) / tracker_.surface().mass();
  if (!first.ids.empty())
    next_id_ = std::int64_t{*std::max_element(first.ids.begin(), first.ids.end())} + 1;
  fades_.assign(first.size(), 1.0);
  join();
}

/// How many samples the surface asks for.
double Population::wanted(const Tracker& tracker) const {
  return density_ * tracker.surface().mass();
}

/// Whether nothing moved, appears or vanishes.
bool Population::rests_at(std::span<const Vec3> vertices) const {
  const auto is_there = [](double fade) { return fade == 1.0; };
  const double missing = wanted(tracker_) - static_cast<double>(tracker_.samples().size());
  return std::abs(missing) < kReluctance && vanishing_.empty() &&
         std::all_of(fades_.begin(), fades_.end(), is_there) && tracker_.rests_at(vertices);
}

/// The tracker's samples, more or fewer where the surface has grown or shrunk.
Samples Population::resized(const Tracker& tracker, Context* context) const {
  const Samples& now = tracker.samples();
  const double wanted = this->wanted(tracker);
  if (std::abs(wanted - static_cast<double>(now.size())) < kReluctance) return now;
  check_wanted(wanted, now.size());
  SampleOptions options;
  options.optimizer = options_.tracker.optimizer;
  options.cells = options_.tracker.cells;
  options.threads = options_.tracker.threads;
  options.seed = static_cast<std::uint64_t>(next_id_);
  Samples result = resample(tracker.surface(), now, static_cast<std::size_t>(std::llround(wanted)),
                            options, context);
  const std::set<std::int32_t> known(now.ids.begin(), now.ids.end());
  const auto is_new = [&](std::int32_t id) { return !known.contains(id); };
  const auto more = std::count_if(result.ids.begin(), result.ids.end(), is_new);
  check_ids_left(next_id_ - 1, static_cast<std::size_t>(more));
  std::int64_t next = next_id_;
  for (std::int32_t& id : result.ids)
    if (is_new(id)) id = static_cast<std::int32_t>(next++);
  return result;
}

std::vector<Population::Fading> Population::vanishing(const Samples& before,
                                                      const Samples& after) const {
  const double step = 1.0 / options_.fade;
  const std::set<std::int32_t> stay(after.ids.begin(), after.ids.end());
  std::vector<Fading> result;
  for (Fading one : vanishing_) {
    one.fade -= step;
    if (one.fade > 0.5 * step) result.push_back(one);
  }
  for (std::size_t k = 0; k < before.size(); ++k)
    if (!stay.contains(before.ids[k]) && fades_[k] - step > 0.5 * step)
      result.push_back({before.ids[k], before.faces[k], before.barycentric[k], fades_[k] - step});
  return result;
}

const Samples& Population::advance(std::span<const Vec3> vertices, Context* context) {
  if (rests_at(vertices)) {
    samples_.report = tracker_.advance(vertices, context).report;
    return samples_;
  }
  Tracker tracker = tracker_;
  Stretch moving(context, 0.0, 0.5), resizing(context, 0.5, 1.0);
  tracker.advance(vertices, moving.context());
  const Samples before = tracker.samples();
  const Samples after = resized(tracker, resizing.context());
  std::vector<Fading> gone = vanishing(before, after);
  std::map<std::int32_t, double> fade_of;
  for (std::size_t k = 0; k < before.size(); ++k)
    fade_of[before.ids[k]] = std::min(1.0, fades_[k] + 1.0 / options_.fade);
  if (after.ids != before.ids) tracker.exchange(after);
  fades_.clear();
  for (const std::int32_t id : after.ids) {
    fades_.push_back(fade_of.contains(id) ? fade_of[id] : 0.0);
    next_id_ = std::max(next_id_, std::int64_t{id} + 1);
  }
  tracker_ = std::move(tracker);
  vanishing_ = std::move(gone);
  join();
  if (context) context->advance(1.0);
  return samples_;
}

void Population::join() {
  samples_ = tracker_.samples();
  samples_.fade = fades_;
  if (vanishing_.empty()) return;
  std::vector<std::int32_t> faces;
  std::vector<Vec3> barycentric;
  for (const Fading& one : vanishing_) {
    faces.push_back(one.face);
    barycentric.push_back(one.barycentric);
    samples_.ids.push_back(one.id);
    samples_.classes.push_back(0);
    samples_.fade.push_back(one.fade);
  }
  const Samples riding = bind_samples(surface(), faces, barycentric);
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(samples_.positions, riding.positions);
  append(samples_.normals, riding.normals);
  append(samples_.faces, riding.faces);
  append(samples_.barycentric, riding.barycentric);
}

}  // namespace dapple
