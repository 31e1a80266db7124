// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/best_remesh.hpp"

#include <dapple/refine.hpp>

#include "base/progress.hpp"
#include "density/piece_finder.hpp"
#include "remesh/measure.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kFirst = 0.6;  // of the progress, if it is done again
constexpr std::size_t kFinerFaces = 40;
constexpr std::size_t kRefinings = 1;  // times that faces are made finer still

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

Beginning on_pieces(const Refined& fine, const Beginning& beginning) {
  Beginning result = beginning;
  result.solution = on_pieces(fine, beginning.solution);
  result.given.sites = on_pieces(fine, beginning.given.sites);
  return result;
}

/// Without lines that cannot be kept, where nothing else has helped.
TracedMesh best_of(Remesher& remesher, Context* context) {
  const std::size_t flaws = remesher.flaws();
  if (flaws == 0) return remesher.result(context);
  const Remesher whole = remesher;  // with all lines
  remesher.give_up(context);
  return (remesher.flaws() < flaws ? remesher : whole).result(context);
}

/// Cells in space reach through walls thinner than themselves; those along the surface do not, but
/// need faces that are smaller than they are. Where flaws remain, sites are closer to each other
/// than elsewhere, and faces are made smaller again.
TracedMesh remesh_along(const Surface& surface, std::size_t count, const RemeshOptions& options,
                        const FeatureLines& lines, const Beginning& beginning, Context* context) {
  const std::size_t most =
      std::min(kMostRefinedFaces, kFinerFaces * (count + surface.face_count()));
  const double longest = kFinerEdge * surface.spacing(count);
  Refined fine = refine_edges(surface, {&longest, 1}, most, nullptr);
  // Finer faces alone may help.
  std::size_t k = fine.surface.face_count() > surface.face_count() ? 0 : 1;
  for (;; ++k) {
    Stretch trying(context, k, kRefinings + 2);
    Stretch first(trying.context(), 0.0, kFirst), second(trying.context(), kFirst, 1.0);
    Remesher remesher(fine.surface, count, options,
                      FeatureLines(fine, lines, rules_of(surface, count, options)),
                      on_pieces(fine, beginning));
    if (k > 0) remesher.follow_surface();
    remesher.run(first.context());
    if (remesher.flaws() > 0 && k == 0) continue;
    if (remesher.flaws() > 0 && k <= kRefinings) {
      Refined finer = fine.then(refine_edges(fine.surface, remesher.finer_edges(), most, nullptr));
      if (finer.surface.face_count() > fine.surface.face_count()) {
        fine = std::move(finer);
        continue;
      }
    }
    TracedMesh made = best_of(remesher, second.context());
    name_parents(fine, made.mesh);
    return made;
  }
}

}  // namespace

TracedMesh best_remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                       const FeatureLines& lines, const Beginning& beginning, Context* context) {
  Stretch first(context, 0.0, kFirst), second(context, kFirst, 1.0);
  Remesher remesher(surface, count, options, lines, beginning);
  remesher.run(first.context());
  const std::size_t flaws = remesher.flaws();
  TracedMesh made;
  if (flaws > 0) {
    const Beginning again =
        beginning.given.size() > 0 ? beginning : Beginning{.solution = remesher.solution()};
    made = remesh_along(surface, count, options, lines, again, second.context());
  }
  if (flaws == 0 || flaws < made.mesh.report.flaws) made = remesher.result(context);
  const StageSpan reporting(context, Stage::kReporting);
  measure_mesh(surface, lines, made.mesh);
  return made;
}

}  // namespace dapple
