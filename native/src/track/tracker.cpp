// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/tracker.hpp>
#include <map>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "sample/validate_samples.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "track/frame_solver.hpp"
#include "track/motion.hpp"
#include "track/transfer.hpp"

namespace dapple {
namespace {

constexpr int kMostParts = 16;   // parts into which the motion of a frame is split
constexpr double kStill = 1e-9;  // motion due to rounding, relative to the size
constexpr double kBound = 0.2;  // share of the progress of a new tracker when the samples are bound
constexpr double kEvaluated = 0.9;  // share of it when the samples are evaluated
constexpr double kHeld = 0.9;       // share of max_slide: a sample that slid farther was held back

/// The samples bound to the surface, to which they must belong.
Samples bound(const Surface& surface, const Samples& samples) {
  check_samples(surface, samples);
  return bind_samples(surface, samples.faces, samples.barycentric, samples.ids, samples.classes);
}

int part_count(const Motion& motion, double longest) {
  if (longest == 0.0 || !(motion.extent > longest)) return 1;
  return static_cast<int>(std::min<double>(std::ceil(motion.extent / longest), kMostParts));
}

/// Optimize the sites on all parts of a split frame except the last one, which is the frame itself.
FrameSolver::Passed approach(const FrameSolver& solver, const Surface& surface, const Sites& first,
                             const Motion& motion, int parts, Moved moved, Context* context) {
  FrameSolver::Passed passed{first, 0};
  for (int part = 1; part < parts; ++part) {
    const double share = static_cast<double>(part) / parts;
    const Surface way = surface.deformed(part_way(surface.vertices(), motion, share));
    const Sites now = carried(way, passed.sites);
    const Sites home = carried(way, first);
    const int evaluations = passed.evaluations;
    Stretch step(context, static_cast<std::size_t>(part - 1), static_cast<std::size_t>(parts));
    passed =
        solver.pass(way, now, solver.recall(way, passed.sites, now), home, step.context(), moved);
    passed.evaluations += evaluations;
  }
  return passed;
}

/// The report of a frame equal to the last one.
Report resting(Report report) {
  report.evaluations = report.iterations = 0;
  report.parts = 1;
  if (report.energies.size() > 1)
    report.energies.erase(report.energies.begin(), report.energies.end() - 1);
  report.slide_mean = report.slide_median = report.slide_max = 0.0;
  return report;
}

}  // namespace

Tracker::Tracker(Surface surface, Samples samples, TrackerOptions options, Context* context)
    : first_surface_(surface), surface_(std::move(surface)), samples_(bound(surface_, samples)) {
  samples_.report = std::move(samples.report);
  if (context) {
    context->check();
    context->advance(kBound);
  }
  Stretch evaluating(context, kBound, kEvaluated);
  with_threads(options.threads, [&] {
    solver_ = std::make_shared<const FrameSolver>(surface_, samples_, std::move(options),
                                                  evaluating.context());
  });
  measured_ = solver_->first_report();
  settled_ = !solver_->any_stranded(surface_, sites_of(samples_));
  if (context) context->advance(1.0);
}

/// Whether nothing moved and no evenness remains to be restored.
bool Tracker::rests_at(std::span<const Vec3> vertices) const {
  return settled_ && surface_.ordered().has_vertices(vertices);
}

const Samples& Tracker::advance(std::span<const Vec3> vertices, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  if (measured_ && rests_at(vertices)) {
    samples_.report = resting(*measured_);
    call.write(samples_.report);
    if (context) context->advance(1.0);
    return samples_;
  }
  const TrackerOptions& options = solver_->options();
  with_threads(options.threads, [&] {
    Surface surface = surface_.deformed(vertices);
    const Motion motion = motion_between(surface_.vertices(), vertices, surface_.faces(),
                                         surface_.distinct_vertices());
    const bool still = motion.extent < kStill;
    const int parts = part_count(motion, options.longest_motion);
    const Sites before = sites_of(samples_);
    const FrameSolver::Passed last =
        approach(*solver_, surface_, before, motion, parts, moved_, call.context());
    const Sites now = carried(surface, last.sites);
    const Sites home = carried(surface, before);
    const Vectors moves = in_stage(call.context(), Stage::kStart,
                                   [&] { return solver_->recall(surface, last.sites, now); });
    const auto last_part = static_cast<std::size_t>(parts - 1);
    Stretch step(call.context(), last_part, last_part + 1);
    auto [samples, settled] =
        solver_->restore(surface, now, moves, &home, still && settled_, step.context(), moved_);
    samples.report.evaluations += last.evaluations;
    samples.report.parts = parts;
    measure_slide(samples.report, samples.positions, home.positions);
    call.write(samples.report);
    std::optional<Report> measured = samples.report;
    settled_ = (still && settled_) ||  // nothing fails from here on
               (settled && samples.report.slide_max < kHeld * options.optimizer.max_slide);
    settled_ = settled_ && moved_ == Moved::kNothing;
    moved_ = Moved::kNothing;
    surface_ = std::move(surface);
    samples_ = std::move(samples);
    measured_ = std::move(measured);
  });
  if (context) context->advance(1.0);
  return samples_;
}

void Tracker::resume(std::span<const Vec3> vertices, const Samples& samples, bool settled) {
  check_same_length("samples", samples.size(), "the tracker's samples", samples_.size());
  Surface surface = surface_.deformed(vertices);
  check_lengths(samples);
  check_bound_sites("samples", std::array<const Surface*, 3>{&surface, &surface_, &first_surface_},
                    sites_of(samples));
  samples_ =
      bind_samples(surface, samples.faces, samples.barycentric, samples_.ids, samples_.classes);
  surface_ = std::move(surface);
  measured_.reset();
  settled_ = settled;
  moved_ = Moved::kNothing;
}

void Tracker::resume_on(const Surface& surface, std::span<const Vec3> vertices,
                        const Samples& samples, const Samples& first,
                        std::vector<SampleClass> classes, bool anywhere, Context* context) {
  check_same_length("samples", samples.size(), "the tracker's samples", samples_.size());
  check_same_length("first", first.size(), "the tracker's samples", samples_.size());
  Surface there = surface.deformed(vertices);
  check_lengths(samples);
  check_lengths(first, "first");
  check_binding("samples", surface, samples.faces, samples.barycentric);
  check_binding("first", surface, first.faces, first.barycentric);
  Samples now =
      bind_samples(there, samples.faces, samples.barycentric, samples_.ids, samples_.classes);
  Sites then = carried(there, sites_of(first));
  solver_ = with_threads(solver_->options().threads, [&] {
    return std::make_shared<const FrameSolver>(
        solver_->on_ground(there, now, std::move(then), std::move(classes), context));
  });
  first_surface_ = surface;
  surface_ = std::move(there);
  samples_ = std::move(now);
  measured_.reset();
  settled_ = false;
  moved_ = anywhere ? Moved::kFaces : Moved::kDensity;
}

/// Continue with other samples on the current frame; samples with known ids keep their place in the
/// first frame's pattern.
void Tracker::exchange(const Samples& samples) {
  std::map<std::int32_t, std::int32_t> known;
  for (std::size_t k = 0; k < samples_.size(); ++k)
    known.emplace(samples_.ids[k], static_cast<std::int32_t>(k));
  std::vector<std::int32_t> origin;
  for (const std::int32_t id : samples.ids) {
    const auto found = known.find(id);
    origin.push_back(found == known.end() ? -1 : found->second);
  }
  solver_ = std::make_shared<const FrameSolver>(solver_->exchanged(origin, samples));
  samples_ = samples;
  measured_.reset();
  settled_ = false;
}

/// Continue from a frame that another tracker has solved.
/// \param first, memory see FrameSolver::replaced()
void Tracker::replace(const Surface& frame, Samples samples, Sites first, PatternMemory memory,
                      bool settled) {
  solver_ = std::make_shared<const FrameSolver>(
      solver_->replaced(samples, std::move(first), std::move(memory)));
  first_surface_ = surface_ = frame;
  samples_ = std::move(samples);
  measured_.reset();
  settled_ = settled;
}

/// Continue on a surface with other faces.
/// \param origin per sample its previous index, or -1 for a new one; new ones come last
/// \param now the initial positions of the samples there
void Tracker::cross(const Surface& next, const Transfer& transfer,
                    std::span<const std::int32_t> origin, const Samples& now, Context* context) {
  const Sites home = sites_of(now);
  Vectors before = home.positions;
  Vectors stayed;
  for (std::size_t k = 0; k < origin.size() && origin[k] >= 0; ++k) {
    before[k] = samples_.positions[static_cast<std::size_t>(origin[k])];
    stayed.push_back(home.positions[k]);
  }
  solver_ = std::make_shared<const FrameSolver>(
      solver_->transplanted(origin, now, surface_, transfer, context));
  const Vectors moves = in_stage(context, Stage::kStart, [&] {
    return solver_->recall(next, {before, home.faces, home.barycentric}, home);
  });
  auto [samples, settled] = solver_->restore(next, home, moves, &home, false, context);
  measure_slide(samples.report, samples.positions, stayed);
  settled_ = settled && samples.report.slide_max < kHeld * solver_->options().optimizer.max_slide;
  first_surface_ = surface_ = next;
  samples_ = std::move(samples);
  measured_ = samples_.report;
}

}  // namespace dapple
