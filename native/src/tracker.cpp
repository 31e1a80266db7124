// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/tracker.hpp>

#include "clock.hpp"
#include "outcome.hpp"
#include "parallel.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

// A frame this little above the first one's normalised energy is as even to the eye: nothing needs
// to move. (From a Poisson-disk start to convergence the energy falls by about 0.03.)
constexpr double kSlack = 5e-4;

/// How far the samples are from where they were carried, in spacings.
void measure_slide(Samples& samples, const Samples& carried) {
  const double spacing = samples.report.spacing;
  double sum = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double slide = (samples.positions[k] - carried.positions[k]).norm() / spacing;
    samples.report.slide_max = std::max(samples.report.slide_max, slide);
    sum += slide;
  }
  samples.report.slide_mean = samples.size() > 0 ? sum / static_cast<double>(samples.size()) : 0.0;
}

}  // namespace

Tracker::Tracker(Surface surface, Samples samples, TrackerOptions options)
    : surface_(std::move(surface)),
      samples_(
          bind_samples(surface_, samples.faces, samples.barycentric, samples.ids, samples.classes)),
      options_(options) {
  check_at_least("threads", options_.threads, 0);
  samples_.report = samples.report;
  with_threads(options_.threads, [&] {
    const Sites sites{samples_.positions, samples_.faces, {}};
    target_energy_ = evaluate_energy(surface_, sites, options_.optimizer.capacity_weight, nullptr,
                                     options_.cells)
                         .normalised;
  });
}

const Samples& Tracker::advance(std::span<const Vec3> vertices, Context* context) {
  const Clock clock;
  if (context) context->check();
  with_threads(options_.threads, [&] {
    Surface surface = surface_.deformed(vertices);
    const Samples carried =
        bind_samples(surface, samples_.faces, samples_.barycentric, samples_.ids, samples_.classes);
    OptimizerOptions options = options_.optimizer;
    options.target_energy = std::max(options.target_energy, target_energy_ + kSlack);
    OptimizerResult found =
        optimize(SurfaceDomain(surface, options_.cells),
                 {carried.positions, carried.faces, carried.barycentric}, options, context);
    Samples samples = to_samples(surface, std::move(found), samples_.ids, samples_.classes);
    measure_slide(samples, carried);
    samples.report.seconds = clock.seconds();
    surface_ = std::move(surface);
    samples_ = std::move(samples);
  });
  if (context) context->advance(1.0);
  return samples_;
}

}  // namespace dapple
