// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/refine.hpp>
#include <dapple/remesh.hpp>
#include <limits>
#include <tuple>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "density/piece_finder.hpp"
#include "remesh/adapted_density.hpp"
#include "remesh/measure.hpp"
#include "remesh/remesher.hpp"
#include "sample/timed_call.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kFirst = 0.6, kSecond = 0.8;  // of the progress, if it is done again
constexpr std::size_t kFinerFaces = 40;
constexpr std::size_t kRefinings = 1;  // times that faces are made finer still
constexpr double kLearned = 0.7;       // of the progress, if the density is adapted
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

/// Move the vertices from finer faces to those of the surface.
void name_parents(const Refined& fine, RemeshResult& mesh) {
  const OrderedSurface& whole = fine.original.ordered();
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const auto piece = as_index(mesh.source_faces[k]);
    Vec3 weights = Vec3::Zero();
    for (int c = 0; c < 3; ++c)
      weights += mesh.barycentric[k][c] * fine.barycentric[piece][as_index(c)];
    mesh.source_faces[k] = fine.parents[piece];
    mesh.barycentric[k] = weights;
    mesh.vertices[k] = whole.point(whole.ordered_face(fine.parents[piece]), weights);
  }
}

/// Sites of a surface on its finer faces.
Sites on_pieces(const Refined& fine, const Sites& sites) {
  const PieceFinder finder(fine);
  Sites result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto [face, inside] = finder.find(sites.faces[k], sites.barycentric[k]);
    result.positions.push_back(fine.surface.point(face, inside));
    result.faces.push_back(face);
    result.barycentric.push_back(inside);
  }
  return result;
}

/// Cells in space reach through walls thinner than themselves; those along the surface do not, but
/// need faces that are smaller than they are. Where flaws remain, sites are closer to each other
/// than elsewhere, and faces are made smaller again.
/// \param start free sites of a solution on the surface
RemeshResult remesh_along(const Surface& surface, std::size_t count, const RemeshOptions& options,
                          const FeatureLines& lines, const Sites& start, Context* context) {
  const std::size_t most =
      std::min(kMostRefinedFaces, kFinerFaces * (count + surface.face_count()));
  const double longest = kFinerEdge * surface.spacing(count);
  Refined fine = refine_edges(surface, {&longest, 1}, most, nullptr);
  for (std::size_t k = 0;; ++k) {
    Stretch trying(context, k, kRefinings + 2);
    Stretch first(trying.context(), 0.0, kFirst), second(trying.context(), kFirst, kSecond),
        third(trying.context(), kSecond, 1.0);
    Remesher remesher(fine.surface, count, options,
                      FeatureLines(fine, lines, rules_of(surface, count, options)),
                      on_pieces(fine, start));
    if (k > 0) remesher.follow_surface();  // finer faces alone may help
    remesher.run(first.context());
    if (remesher.flaws() > 0 && k == 0) continue;
    if (remesher.flaws() > 0 && k <= kRefinings) {
      fine = fine.then(refine_edges(fine.surface, remesher.finer_edges(), most, nullptr));
      continue;
    }
    if (remesher.flaws() > 0) remesher.insist(second.context());
    RemeshResult made;
    if (const std::size_t flaws = remesher.flaws(); flaws > 0) {
      const Remesher whole = remesher;  // with all lines
      remesher.give_up(third.context());
      made = (remesher.flaws() < flaws ? remesher : whole).result(context);
    } else {
      made = remesher.result(context);
    }
    name_parents(fine, made);
    return made;
  }
}

/// \param lines of the surface, with any density
RemeshResult best_remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                         const FeatureLines& lines, Context* context) {
  Stretch first(context, 0.0, kFirst), second(context, kFirst, 1.0);
  Remesher remesher(surface, count, options, lines);
  remesher.run(first.context());
  const std::size_t flaws = remesher.flaws();
  RemeshResult made;
  if (flaws > 0)
    made = remesh_along(surface, count, options, lines, remesher.free_sites(), second.context());
  if (flaws == 0 || flaws < made.report.flaws) made = remesher.result(context);
  const StageSpan reporting(context, Stage::kReporting);
  measure_mesh(surface, lines, made);
  return made;
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
    Remesher remesher(dense, count, rough, lines, start);
    remesher.run(round.context());
    start = remesher.free_sites();
    const RemeshResult mesh = remesher.result(context);
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
      best_remesh(with_values(surface, adapted.density), count, options, lines, last.context());
  mesh.density = adapted.density;
  mesh.report.evaluations += adapted.evaluations;
  mesh.report.distance = check.distances(mesh, context).largest;
  return mesh;
}

RemeshResult remesh_by(const Surface& surface, std::size_t count, const RemeshOptions& options,
                       Context* context) {
  const FeatureLines lines(surface, rules_of(surface, count, options), context);
  return options.adaptive ? adapted_remesh(surface, count, options, lines, context)
                          : best_remesh(surface, count, options, lines, context);
}

}  // namespace

RemeshResult remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                    Context* context) {
  TimedCall call(context);
  check(count, options);
  if (context) context->check();
  RemeshResult mesh = with_threads(
      options.threads, [&] { return remesh_by(surface, count, options, call.context()); });
  Report times;
  call.write(times);
  mesh.report.seconds = times.seconds;
  mesh.report.profile = times.profile;
  if (context) context->advance(1.0);
  return mesh;
}

}  // namespace dapple
