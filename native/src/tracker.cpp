// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/tracker.hpp>

#include "clock.hpp"
#include "outcome.hpp"
#include "parallel.hpp"
#include "surface_classes.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

// A frame this little above the first one's normalised energy is as even to the eye: nothing needs
// to move. (From a Poisson-disk start to convergence the energy falls by about 0.03.)
constexpr double kSlack = 5e-4;

/// The samples of each class; all of them one class if none is given.
std::vector<SampleClass> counted(std::vector<SampleClass> classes, const Samples& samples) {
  if (classes.empty()) return {{.count = samples.size()}};
  for (SampleClass& member : classes) member.count = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::int32_t c = samples.classes[k];
    if (c < 0 || static_cast<std::size_t>(c) >= classes.size())
      throw ArgumentError(entry("samples.classes", k) + " is " + std::to_string(c) +
                          ", outside 0.." + std::to_string(classes.size() - 1));
    ++classes[static_cast<std::size_t>(c)].count;
  }
  return classes;
}

std::vector<SampleClass> deformed(std::vector<SampleClass> classes,
                                  std::span<const Vec3> vertices) {
  for (SampleClass& member : classes)
    if (member.surface) member.surface = member.surface->deformed(vertices);
  return classes;
}

/// What is minimised on one frame, over domains that it owns.
struct Frame {
  Frame(const Surface& surface, std::span<const SampleClass> classes, const Samples& samples,
        const TrackerOptions& options)
      : problem(surface_classes(surface, classes, options.cells)),
        objective(make_objective(
            problem,
            classes.size() > 1 ? samples.classes : std::vector<std::int32_t>(samples.size(), 0),
            {.sample = {.optimizer = options.optimizer}, .union_weight = options.union_weight})) {}

  ClassProblem problem;
  Objective objective;
};

}  // namespace

Tracker::Tracker(Surface surface, Samples samples, TrackerOptions options,
                 std::vector<SampleClass> classes)
    : surface_(std::move(surface)),
      samples_(
          bind_samples(surface_, samples.faces, samples.barycentric, samples.ids, samples.classes)),
      options_(options),
      classes_(counted(std::move(classes), samples_)) {
  check_at_least("threads", options_.threads, 0);
  check_at_least("union_weight", options_.union_weight, 0.0);
  samples_.report = samples.report;
  with_threads(options_.threads, [&] {
    const Frame frame(surface_, classes_, samples_, options_);
    const std::vector<std::vector<double>> no_gaps(frame.objective.terms.size());
    const State state =
        evaluate(frame.objective, {samples_.positions, samples_.faces, samples_.barycentric},
                 no_gaps, nullptr);
    target_energy_ = normalised_energy(frame.objective, state);
    restoration_.cvt = normalised_cvt(frame.objective, state);
    restoration_.first_spread = capacity_spread(frame.objective, state);
  });
}

const Samples& Tracker::advance(std::span<const Vec3> vertices, Context* context) {
  const Clock clock;
  if (context) context->check();
  with_threads(options_.threads, [&] {
    Surface surface = surface_.deformed(vertices);
    std::vector<SampleClass> classes = deformed(classes_, vertices);
    const Samples carried =
        bind_samples(surface, samples_.faces, samples_.barycentric, samples_.ids, samples_.classes);
    const Frame frame(surface, classes, carried, options_);
    OptimizerOptions options = options_.optimizer;
    if (options.method == Method::kTrustRegion)
      options.restore = restoration_;
    else
      options.target_energy = std::max(options.target_energy, target_energy_ + kSlack);
    const Minimum found = minimize(
        frame.objective, {carried.positions, carried.faces, carried.barycentric}, options, context);
    Samples samples = to_samples(surface, frame.objective, found, classes.size(), samples_.ids);
    samples.classes = samples_.classes;
    measure_slide(samples.report, samples.positions, carried.positions);
    samples.report.seconds = clock.seconds();
    surface_ = std::move(surface);
    classes_ = std::move(classes);
    samples_ = std::move(samples);
  });
  if (context) context->advance(1.0);
  return samples_;
}

}  // namespace dapple
