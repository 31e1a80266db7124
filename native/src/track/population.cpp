// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/domain.hpp>
#include <dapple/population.hpp>
#include <dapple/resample.hpp>
#include <limits>
#include <map>
#include <set>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/timed_call.hpp"
#include "track/class_parts.hpp"
#include "track/frame_solver.hpp"
#include "track/transfer.hpp"
#include "track/turnover.hpp"

namespace dapple {
namespace {

// The number of samples changes only if it differs from the ideal number by at least this much.
// Otherwise the same sample of a breathing body would appear and vanish repeatedly.
constexpr double kLeastChange = 0.75;
constexpr double kResized =
    0.8;  // share of the progress of a frame: births and deaths of all classes are done
constexpr double kSameShape =
    0.0025;  // relative difference of area between meshes of the same shape
// Progress of a frame with new faces: positions are found, births and deaths are done.
constexpr double kFound = 0.1, kBegun = 0.4;

void check_wanted(double wanted, std::size_t now) {
  if (!(wanted <= static_cast<double>(kMostSamples)))
    throw ArgumentError("vertices span a surface that needs " + number(wanted) +
                        " samples instead of " + std::to_string(now) + ": at most " +
                        std::to_string(kMostSamples) + " are possible");
}

std::size_t whole_count(double wanted, std::size_t now) {
  if (std::abs(wanted - static_cast<double>(now)) < kLeastChange) return now;
  check_wanted(wanted, now);
  return static_cast<std::size_t>(std::llround(wanted));
}

}  // namespace

struct Population::Crossing {
  Tracker tracker;
  std::vector<Fading> vanishing;
  double density;
};

Population::Population(Surface surface, Samples samples, PopulationOptions options,
                       Context* context)
    : tracker_(std::move(surface), std::move(samples), options.tracker, context),
      options_(std::move(options)),
      next_id_(0) {
  check_options(options_);
  std::vector<SampleClass> classes = std::exchange(options_.tracker.classes, {});
  kinds_.resize(std::max<std::size_t>(classes.size(), 1));
  const Samples& first = tracker_.samples();
  for (std::size_t c = 0; c < kinds_.size(); ++c) {
    if (!classes.empty()) kinds_[c].surface = std::move(classes[c].surface);
    kinds_[c].first_density =
        static_cast<double>(count_of(first, c)) / surface_of(tracker_, c).capacity();
    kinds_[c].density = kinds_[c].first_density;
  }
  if (!first.ids.empty())
    next_id_ = std::int64_t{*std::max_element(first.ids.begin(), first.ids.end())} + 1;
  fades_.assign(first.size(), 1.0);
  join();
}

std::size_t Population::count_of(const Samples& samples, std::size_t kind) const {
  if (kinds_.size() == 1) return samples.size();
  return static_cast<std::size_t>(
      std::count(samples.classes.begin(), samples.classes.end(), static_cast<std::int32_t>(kind)));
}

/// The tracker's surface, with the density of a class.
Surface Population::surface_of(const Tracker& tracker, std::size_t kind) const {
  const std::optional<Surface>& own = kinds_[kind].surface;
  return own ? own->deformed(tracker.surface().vertices()) : tracker.surface();
}

/// The number of samples of a class that the surface needs.
std::size_t Population::wanted(const Tracker& tracker, std::size_t kind) const {
  return whole_count(kinds_[kind].density * surface_of(tracker, kind).capacity(),
                     count_of(tracker.samples(), kind));
}

/// Whether no vertex has moved and no sample appears or vanishes.
bool Population::rests_at(std::span<const Vec3> vertices) const {
  const auto is_there = [](double fade) { return fade == 1.0; };
  if (!vanishing_.empty() || !std::all_of(fades_.begin(), fades_.end(), is_there) ||
      !tracker_.rests_at(vertices))
    return false;
  for (std::size_t c = 0; c < kinds_.size(); ++c)
    if (wanted(tracker_, c) != count_of(tracker_.samples(), c)) return false;
  return true;
}

/// The tracker's samples, with births and deaths where the surface has grown or shrunk.
Samples Population::resized(const Tracker& tracker, Context* context) const {
  if (kinds_.size() == 1) return resized(tracker, 0, next_id_, context);
  std::vector<Samples> parts;
  std::int64_t next = next_id_;
  for (std::size_t c = 0; c < kinds_.size(); ++c) {
    Stretch part(context, c, kinds_.size());
    parts.push_back(resized(tracker, c, next, part.context()));
    for (const std::int32_t id : parts.back().ids) next = std::max(next, std::int64_t{id} + 1);
  }
  return joined(tracker.surface(), tracker.samples(), parts);
}

/// The samples of one class, with births and deaths.
Samples Population::resized(const Tracker& tracker, std::size_t kind, std::int64_t next_id,
                            Context* context) const {
  const Surface surface = surface_of(tracker, kind);
  Samples now = kinds_.size() == 1
                    ? tracker.samples()
                    : of_class(surface, tracker.samples(), static_cast<std::int32_t>(kind));
  const std::size_t count = wanted(tracker, kind);
  if (count == now.size()) return now;
  // The target energy suffices here, because the following frames restore the evenness of the first
  // one.
  now.report.evenness.capacity_variation = std::numeric_limits<double>::infinity();
  const ResampleOptions options{.seed = static_cast<std::uint64_t>(next_id),
                                .optimizer = options_.tracker.optimizer,
                                .cells = options_.tracker.cells,
                                .threads = options_.tracker.threads};
  Samples result = resample(surface, now, count, options, context);
  const std::set<std::int32_t> known(now.ids.begin(), now.ids.end());
  const auto is_new = [&](std::int32_t id) { return !known.contains(id); };
  const auto more = std::count_if(result.ids.begin(), result.ids.end(), is_new);
  check_ids_left(next_id - 1, static_cast<std::size_t>(more));
  for (std::int32_t& id : result.ids)
    if (is_new(id)) id = static_cast<std::int32_t>(next_id++);
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
      result.push_back({before.ids[k], before.faces[k], before.barycentric[k], fades_[k] - step,
                        before.classes[k]});
  return result;
}

const Samples& Population::advance(std::span<const Vec3> vertices, Context* context) {
  if (rests_at(vertices)) {
    Report report = tracker_.advance(vertices, context).report;
    samples_.report = std::move(report);
    return samples_;
  }
  Tracker tracker = tracker_;
  Stretch moving(context, 0.0, 0.5), resizing(context, 0.5, kinds_.size() == 1 ? 1.0 : kResized);
  Stretch evening(context, kResized, 1.0);
  tracker.advance(vertices, moving.context());
  const Samples before = tracker.samples();
  const Samples after = resized(tracker, resizing.context());
  std::vector<Fading> gone = vanishing(before, after);
  if (after.ids != before.ids) {
    tracker.exchange(after);
    // Births and deaths are per class; only the tracker knows the evenness of the union.
    if (kinds_.size() > 1) tracker.advance(vertices, evening.context());
  }
  take(std::move(tracker), std::move(gone));
  if (context) context->advance(1.0);
  return samples_;
}

/// Whether a surface may be a deformation of the current one.
bool Population::is_of_this_body(const Surface& other) const {
  const Surface& one = surface();
  if (one.vertex_count() != other.vertex_count() || one.face_count() != other.face_count() ||
      one.density_at() != other.density_at() || one.density() != other.density())
    return false;
  return one.same_faces(other) ||
         (one.faces() == other.faces() && one.welded_faces() == other.welded_faces());
}

const Samples& Population::advance(const Surface& next, Context* context) {
  if (is_of_this_body(next)) return advance(next.vertices(), context);
  TimedCall call(context);
  if (context) context->check();
  check_one_kind();
  Crossing crossing =
      with_threads(options_.tracker.threads, [&] { return cross(next, call.context()); });
  take(std::move(crossing.tracker), std::move(crossing.vanishing));
  kinds_[0].density = crossing.density;
  call.write(samples_.report);
  if (context) context->advance(1.0);
  return samples_;
}

void Population::check_one_kind() const {
  if (kinds_.size() > 1 || kinds_[0].surface)
    throw ArgumentError(
        "the surface has other faces than the last one: only samples without classes can "
        "continue there, these have " +
        std::to_string(kinds_.size()));
}

/// The next frame, on a surface with other faces.
Population::Crossing Population::cross(const Surface& next, Context* context) const {
  const Samples& last = tracker_.samples();
  const auto now = static_cast<double>(last.size());
  const Kind& kind = kinds_[0];
  Crossing result{tracker_,
                  {},
                  std::clamp(now / next.capacity(), (1.0 - kSameShape) * kind.first_density,
                             (1.0 + kSameShape) * kind.first_density)};
  const std::size_t count = whole_count(result.density * next.capacity(), last.size());
  Stretch beginning(context, kFound, kBegun), evening(context, kBegun, 1.0);
  const Transfer transfer(surface(), next, sites_of(last), {kind.density, options_.reach}, context);
  const SurfaceDomain domain(next, options_.tracker.cells);
  const auto [sites, origin] = turn_over(next, domain, transfer.samples(), last.size(), count,
                                         static_cast<std::uint64_t>(next_id_), beginning.context());
  const Samples samples = bind_samples(next, sites.faces, sites.barycentric, ids_of(origin));
  result.vanishing = transferred(vanishing(last, samples), transfer, context);
  result.tracker.cross(next, transfer, origin, samples, evening.context());
  return result;
}

/// The ids of the current samples, and new ids for new samples.
/// \param origin per sample its previous index, or -1
std::vector<std::int32_t> Population::ids_of(std::span<const std::int32_t> origin) const {
  check_ids_left(next_id_ - 1,
                 static_cast<std::size_t>(std::count(origin.begin(), origin.end(), -1)));
  std::vector<std::int32_t> ids;
  std::int64_t next = next_id_;
  for (const std::int32_t o : origin)
    ids.push_back(o < 0 ? static_cast<std::int32_t>(next++)
                        : tracker_.samples().ids[static_cast<std::size_t>(o)]);
  return ids;
}

/// The fading samples that have a position on the other surface.
std::vector<Population::Fading> Population::transferred(const std::vector<Fading>& fading,
                                                        const Transfer& transfer,
                                                        const Context* context) const {
  Sites sites;
  for (const Fading& one : fading) {
    sites.positions.push_back(surface().point(one.face, one.barycentric));
    sites.faces.push_back(one.face);
    sites.barycentric.push_back(one.barycentric);
  }
  const Transferred found = transfer.find(sites, context);
  std::vector<Fading> result;
  for (std::size_t k = 0; k < found.which.size(); ++k) {
    const Fading& one = fading[static_cast<std::size_t>(found.which[k])];
    result.push_back(
        {one.id, found.sites.faces[k], found.sites.barycentric[k], one.fade, one.of_class});
  }
  return result;
}

/// Store the next frame's samples and those that vanish.
void Population::take(Tracker tracker, std::vector<Fading> vanishing) {
  Population next = *this;  // so that an exception leaves the population unchanged
  next.settle(std::move(tracker), std::move(vanishing));
  *this = std::move(next);
}

void Population::settle(Tracker tracker, std::vector<Fading> vanishing) {
  std::map<std::int32_t, double> fade_of;
  const Samples& before = tracker_.samples();
  for (std::size_t k = 0; k < before.size(); ++k)
    fade_of[before.ids[k]] = std::min(1.0, fades_[k] + 1.0 / options_.fade);
  const std::size_t last = before.size();
  std::size_t births = 0;
  fades_.clear();
  for (const std::int32_t id : tracker.samples().ids) {
    const auto known = fade_of.find(id);
    births += known == fade_of.end() ? 1 : 0;
    fades_.push_back(known == fade_of.end() ? 0.0 : known->second);
    next_id_ = std::max(next_id_, std::int64_t{id} + 1);
  }
  tracker_ = std::move(tracker);
  vanishing_ = std::move(vanishing);
  join();
  samples_.report.births = births;
  samples_.report.deaths = last + births - fades_.size();
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
    samples_.classes.push_back(one.of_class);
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
