// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/remesh.hpp>
#include <limits>
#include <tuple>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "remesh/adapted_density.hpp"
#include "remesh/best_remesh.hpp"
#include "remesh/remesher.hpp"
#include "sample/timed_call.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kLearned = 0.7;  // of the progress, if the density is adapted
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr int kAdaptations = 4;       // meshes after the first, to be nearer to the surface
constexpr int kAdaptingPatience = 2;  // of them without gain
constexpr double kRough = 10.0;       // times the tolerance, of these meshes
constexpr double kFlat = 1e-6;        // spacings: such a distance is rounding

void check(std::size_t count, const RemeshOptions& options) {
  check_options(options);
  if (count == 0) throw ArgumentError("count is 0: it must be >= 1");
  check_count("count", count);
}

/// A density at corners, and the evaluations by which it was found.
struct Adapted {
  std::vector<double> density;  // empty: the surface's own
  int evaluations = 0;
};

Surface with_values(const Surface& surface, const std::vector<double>& density) {
  return density.empty() ? surface : surface.with_density({DensityAt::kCorners, density});
}

/// The density by which a mesh is nearest to the surface. It is learned from meshes that
/// are not solved to their end, each denser where the one before was far from the surface.
Adapted adapted_density(const Surface& surface, std::size_t count, const RemeshOptions& options,
                        const FeatureLines& lines, const DistanceCheck& check, Context* context) {
  RemeshOptions rough = options;
  rough.max_distance = 0.0;
  rough.optimizer.tolerance *= kRough;
  AdaptedDensity density(surface, count);
  Adapted best;
  std::vector<double> now;
  Sites start;
  auto least = std::tuple(kNone, kNone, 0.0);  // flaws, vertices, distance
  for (int k = 0, since = 0; k <= kAdaptations && since < kAdaptingPatience; ++k) {
    Stretch round(context, k / (kAdaptations + 1.0), (k + 1.0) / (kAdaptations + 1.0));
    const Surface dense = with_values(surface, now);
    Remesher remesher(dense, count, rough, lines, {.solution = start});
    remesher.run(round.context());
    // Meshes from new starts come nearer: without lines, or if fewer sites are on lines than
    // before.
    if (!lines.chains().empty()) start = remesher.free_sites();
    const RemeshResult mesh = remesher.result(context).mesh;
    best.evaluations += mesh.report.evaluations;
    const MeshDistances far = check.distances(mesh, context);
    const auto worth = std::tuple(mesh.report.flaws, mesh.vertices.size(), far.largest);
    since = worth < least ? 0 : since + 1;
    if (worth < least) best.density = now;
    least = std::min(least, worth);
    if (far.largest <= kFlat * surface.spacing(count)) break;
    density.learn(mesh.vertices, far.of_vertices);
    now = density.values();
  }
  return best;
}

RemeshResult adapted_remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                            const FeatureLines& lines, Context* context) {
  Stretch learning(context, 0.0, kLearned), last(context, kLearned, 1.0);
  const DistanceCheck check(surface, lines, context);
  const Adapted adapted =
      adapted_density(surface, count, options, lines, check, learning.context());
  RemeshResult mesh =
      best_remesh(with_values(surface, adapted.density), count, options, lines, {}, last.context())
          .mesh;
  mesh.density = adapted.density;
  mesh.report.evaluations += adapted.evaluations;
  mesh.report.distance = check.distances(mesh, context).largest;
  return mesh;
}

RemeshResult remesh_by(const Surface& surface, std::size_t count, const RemeshOptions& options,
                       Context* context) {
  const FeatureLines lines(surface, rules_of(surface, count, options), context);
  return options.adaptive ? adapted_remesh(surface, count, options, lines, context)
                          : best_remesh(surface, count, options, lines, {}, context).mesh;
}

}  // namespace

RemeshResult remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                    Context* context) {
  TimedCall call(context);
  check(count, options);
  if (context) context->check();
  RemeshResult mesh = with_threads(
      options.threads, [&] { return remesh_by(surface, count, options, call.context()); });
  call.write(mesh.report);
  if (context) context->advance(1.0);
  return mesh;
}

}  // namespace dapple
