// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <map>
#include <numeric>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "relax/relaxation.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "sample/validate_samples.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

using Indices = std::vector<std::int32_t>;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

std::vector<OrderedFace> ordered_faces(const Surface& surface,
                                       std::span<const std::int32_t> faces) {
  std::vector<OrderedFace> result;
  result.reserve(faces.size());
  for (const std::int32_t face : faces) result.push_back(surface.ordered().counted_face(face));
  std::sort(result.begin(), result.end());
  return result;
}

void check(const Surface& surface, const Samples& samples, std::span<const std::int32_t> changed,
           const RelaxOptions& options) {
  check_options(options.optimizer);
  check_binding("samples", surface, samples.faces, samples.barycentric);
  check_lengths(samples);
  check_face_indices("changed", changed, surface.face_count());
  for (std::size_t k = 0; k < options.locked.size(); ++k)
    if (options.locked[k] < 0 || at(options.locked[k]) >= samples.size())
      throw ArgumentError(entry("locked", k) + " is " + std::to_string(options.locked[k]) +
                          ", outside 0.." + std::to_string(samples.size() - 1));
  for (std::size_t k = 0; k < samples.classes.size(); ++k)
    if (samples.classes[k] != samples.classes[0])
      throw ArgumentError(entry("samples.classes", k) + " is " +
                          std::to_string(samples.classes[k]) + " and the first is " +
                          std::to_string(samples.classes[0]) +
                          ": samples of one class alone can be relaxed");
  if (options.count) check_count("count", *options.count);
}

/// The faces where something has changed, and those of samples that are where the density is 0; all
/// faces where only the count is to be another.
std::vector<OrderedFace> faces_to_relax(const Surface& surface, const Sites& sites,
                                        std::span<const std::int32_t> changed,
                                        const RelaxOptions& options) {
  const bool resized = options.count && *options.count != sites.size();
  Indices faces(changed.begin(), changed.end());
  if (faces.empty() && resized) {
    faces.resize(surface.face_count());
    std::iota(faces.begin(), faces.end(), 0);
  }
  std::vector<bool> locked(sites.size(), surface.uniform());
  for (const std::int32_t k : options.locked) locked[at(k)] = true;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (!locked[k] && !is_on_density(surface, sites.faces[k], sites.barycentric[k]))
      faces.push_back(sites.faces[k]);
  std::vector<OrderedFace> result = ordered_faces(surface, faces);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

/// The samples on changed faces where these have carried them, all others as they are.
Sites carried(const Surface& surface, const Samples& samples,
              std::span<const std::int32_t> changed) {
  std::vector<bool> is_changed(surface.face_count(), false);
  for (const std::int32_t face : changed) is_changed[at(face)] = true;
  Sites sites{samples.positions, samples.faces, samples.barycentric};
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (is_changed[at(sites.faces[k])])
      sites.positions[k] = surface.point(sites.faces[k], sites.barycentric[k]);
  check_bound_sites("samples", surface, sites);
  return sites;
}

/// Add a first site where a component without any has got a density.
void settle_components(const Surface& surface, std::span<const OrderedFace> changed, Sites& sites) {
  const OrderedSurface& mesh = surface.ordered();
  if (mesh.components() < 2) return;
  std::vector<bool> settled(at(mesh.components()), false);
  for (const std::int32_t face : sites.faces)
    settled[at(mesh.component(mesh.ordered_face(face)))] = true;
  std::map<std::int32_t, OrderedFace> largest;  // the changed face of most capacity, by component
  for (const OrderedFace face : changed) {
    if (settled[at(mesh.component(face))]) continue;
    OrderedFace& most = largest.try_emplace(mesh.component(face), face).first->second;
    if (mesh.geometry(face).moments.capacity > mesh.geometry(most).moments.capacity) most = face;
  }
  const Vec3 middle = Vec3::Constant(1.0 / 3.0);
  for (const auto& [component, face] : largest) {
    if (!(mesh.geometry(face).moments.capacity > 0.0)) continue;
    sites.positions.push_back(mesh.point(face, middle));
    sites.faces.push_back(mesh.original_face(face));
    sites.barycentric.push_back(middle);
  }
}

/// Per welded vertex of the surface's own order, whether it is a corner of a changed face.
std::vector<bool> touched_vertices(const Surface& surface, std::span<const OrderedFace> changed) {
  std::vector<bool> touched(surface.vertex_count(), false);
  for (const OrderedFace face : changed)
    for (const std::int32_t v : surface.ordered().welded_corners(face)) touched[at(v)] = true;
  return touched;
}

/// The normals of samples that have moved or have come, or where a vertex's normal may be another.
void renew_normals(const Surface& surface, std::span<const OrderedFace> changed,
                   const std::vector<bool>& moved, Samples& samples) {
  const std::vector<bool> touched = touched_vertices(surface, changed);
  Indices which, faces;
  Vectors weights;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const OrderedFace face = surface.ordered().ordered_face(samples.faces[k]);
    const Face corners = surface.ordered().welded_corners(face);
    if (!moved[k] && !surface.has_normals() &&
        std::none_of(corners.begin(), corners.end(),
                     [&](std::int32_t v) { return touched[at(v)]; }))
      continue;
    which.push_back(static_cast<std::int32_t>(k));
    faces.push_back(samples.faces[k]);
    weights.push_back(samples.barycentric[k]);
  }
  const std::vector<Vec3> normals = surface.normals(faces, weights);
  for (std::size_t k = 0; k < which.size(); ++k) samples.normals[at(which[k])] = normals[k];
}

std::int64_t last_id(const Samples& samples) {
  return samples.ids.empty() ? -1 : *std::max_element(samples.ids.begin(), samples.ids.end());
}

/// The samples that are left, then the new ones.
Samples assemble(const Surface& surface, const Samples& before, const Sites& carried,
                 const Relaxation& found, std::span<const OrderedFace> changed) {
  Samples result;
  result.report = found.report();
  std::vector<bool> moved;
  Vectors now, then;
  const Sites& sites = found.sites();
  std::int64_t id = last_id(before);
  check_ids_left(id, sites.size() - before.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (!found.is_alive(k)) continue;
    const bool old = k < before.size();
    result.positions.push_back(sites.positions[k]);
    result.faces.push_back(sites.faces[k]);
    result.barycentric.push_back(sites.barycentric[k]);
    result.normals.push_back(old ? before.normals[k] : Vec3::Zero());
    result.ids.push_back(old ? before.ids[k] : static_cast<std::int32_t>(++id));
    result.classes.push_back(before.classes[old ? k : 0]);
    if (!before.fade.empty()) result.fade.push_back(old ? before.fade[k] : 1.0);
    moved.push_back(found.is_free(k));
    if (!old || !found.is_free(k)) continue;
    now.push_back(sites.positions[k]);
    then.push_back(carried.positions[k]);
  }
  renew_normals(surface, changed, moved, result);
  result.report.count = result.size();
  result.report.spacing = surface.spacing(result.size());
  measure_slide(result.report, now, then);
  return result;
}

Samples from_nothing(const Surface& surface, const Samples& samples, const RelaxOptions& options,
                     Context* context) {
  return resample(
      surface, samples, *options.count,
      {.seed = options.seed, .optimizer = options.optimizer, .threads = options.threads}, context);
}

}  // namespace

Samples relax(const Surface& surface, const Samples& samples, std::span<const std::int32_t> changed,
              const RelaxOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check(surface, samples, changed, options);
  const Sites before = carried(surface, samples, changed);
  if (samples.size() == 0)
    return options.count.value_or(0) > 0 ? from_nothing(surface, samples, options, context)
                                         : samples;
  const std::vector<OrderedFace> faces = faces_to_relax(surface, before, changed, options);
  if (faces.empty()) return samples;
  Samples result = with_threads(options.threads, [&] {
    Sites sites = before;
    const CellSurface on =
        cell_surface(surface, options.count.value_or(sites.size()), Cells::kConnected);
    const Surface& sided = on.uncut(surface);
    settle_components(sided, faces, sites);
    std::vector<bool> locked(sites.size(), false);
    for (const std::int32_t k : options.locked) locked[at(k)] = true;
    Relaxation relaxation(sided, std::move(sites), std::move(locked), options);
    in_stage(call.context(), Stage::kStart, [&] { relaxation.run(faces, call.context()); });
    return in_stage(call.context(), Stage::kReporting,
                    [&] { return assemble(surface, samples, before, relaxation, faces); });
  });
  call.write(result.report);
  if (context) context->advance(1.0);
  return result;
}

std::vector<std::int32_t> changed_faces(const Surface& before, const Surface& after) {
  if (!before.same_faces(after))
    throw ArgumentError(
        "after has other faces than before: make it by deformed() or with_density()");
  std::vector<std::int32_t> result;
  for (const OrderedFace face : after.ordered().changed_faces(before.ordered()))
    result.push_back(after.ordered().original_face(face));
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace dapple
