// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/relax.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "optimize/discs.hpp"
#include "relax/class_relaxation.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "sample/validate_samples.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

using Indices = std::vector<std::int32_t>;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

void check_one_class(const Samples& samples) {
  for (std::size_t k = 0; k < samples.classes.size(); ++k)
    if (samples.classes[k] != samples.classes[0])
      throw ArgumentError(entry("samples.classes", k) + " is " +
                          std::to_string(samples.classes[k]) + " and the first is " +
                          std::to_string(samples.classes[0]) +
                          ": pass classes, one for each class of samples");
}

void check_classes(const Surface& surface, const Samples& samples, const RelaxOptions& options) {
  const std::size_t count = options.classes.size();
  if (options.count)
    throw ArgumentError("count is " + std::to_string(*options.count) +
                        " and classes are given: omit it, each class has its own count");
  std::size_t sum = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const SampleClass& one = options.classes[c];
    check_count(entry("classes", c) + ".count", one.count);
    check_at_least((entry("classes", c) + ".radius").c_str(), one.radius, 0.0);
    if (one.surface && !one.surface->same_faces(surface))
      throw ArgumentError(entry("classes", c) +
                          " has a surface with other faces: create it by with_density()");
    if (one.locked.size() > 0)
      throw ArgumentError(entry("classes", c) +
                          ".locked: indices of samples are needed, as locked");
    sum += one.count;
  }
  check_count("the sum of all counts", sum);
  for (std::size_t k = 0; k < samples.classes.size(); ++k)
    if (samples.classes[k] < 0 || at(samples.classes[k]) >= count)
      throw ArgumentError(entry("samples.classes", k) + " is " +
                          std::to_string(samples.classes[k]) + ", outside 0.." +
                          std::to_string(count - 1));
}

void check(const Surface& surface, const Samples& samples, std::span<const std::int32_t> changed,
           const RelaxOptions& options) {
  check_options(options);
  check_binding("samples", surface, samples.faces, samples.barycentric);
  check_lengths(samples);
  check_face_indices("changed", changed, surface.face_count());
  for (std::size_t k = 0; k < options.locked.size(); ++k)
    if (options.locked[k] < 0 || at(options.locked[k]) >= samples.size())
      throw ArgumentError(entry("locked", k) + " is " + std::to_string(options.locked[k]) +
                          ", outside 0.." + std::to_string(samples.size() - 1));
  if (options.count) check_count("count", *options.count);
  options.classes.empty() ? check_one_class(samples) : check_classes(surface, samples, options);
}

/// The samples; those on changed faces are moved with their faces.
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

/// Per welded vertex of the surface's own order, whether it is a corner of a changed face.
std::vector<bool> touched_vertices(const Surface& surface, std::span<const std::int32_t> changed) {
  std::vector<bool> touched(surface.vertex_count(), false);
  for (const std::int32_t face : changed)
    for (const std::int32_t v :
         surface.ordered().welded_corners(surface.ordered().counted_face(face)))
      touched[at(v)] = true;
  return touched;
}

/// The normals of samples that have moved or are new, or where a vertex's normal may have changed.
void renew_normals(const Surface& surface, std::span<const std::int32_t> changed,
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

/// A sample of a class, and its index among the given ones; new ones have none.
struct Row {
  const RelaxedClass* of;
  std::size_t k;
  std::size_t given;

  [[nodiscard]] bool is_old() const { return k < of->rows.size(); }
  [[nodiscard]] bool has_moved() const { return of->free[k]; }
};

/// The remaining samples in their previous order, then the new ones, class by class.
std::vector<Row> rows_of(std::span<const RelaxedClass> classes, std::size_t given) {
  std::vector<Row> old(given, Row{}), rows;
  for (const RelaxedClass& one : classes)
    for (std::size_t k = 0; k < one.rows.size(); ++k)
      if (one.alive[k]) old[at(one.rows[k])] = {&one, k, at(one.rows[k])};
  for (const Row& row : old)
    if (row.of) rows.push_back(row);
  for (const RelaxedClass& one : classes)
    for (std::size_t k = one.rows.size(); k < one.sites.size(); ++k)
      if (one.alive[k]) rows.push_back({&one, k, 0});
  return rows;
}

/// Note the pair of discs that overlaps most.
void note_overlap(const RelaxOptions& options, Samples& result) {
  std::vector<double> radii;
  if (!options.classes.empty())
    for (const std::int32_t c : result.classes) radii.push_back(options.classes[at(c)].radius);
  if (std::all_of(radii.begin(), radii.end(), [](double radius) { return radius == 0.0; })) return;
  const Sites sites{result.positions, result.faces, result.barycentric};
  const Repulsion discs = evaluate_disc_repulsion({sites, result.normals, radii}, 1.0);
  const ClosePair* worst = worst_pair(discs);
  if (!worst) return;
  result.report.worst_overlap = worst->overlap;
  result.report.overlapping = {worst->i, worst->j};
}

Samples assemble(const Surface& surface, const Samples& before, const Sites& carried,
                 std::span<const RelaxedClass> classes, std::span<const std::int32_t> changed) {
  const std::vector<Row> rows = rows_of(classes, before.size());
  Samples result;
  std::vector<bool> moved;
  Vectors now, then;
  std::int64_t id = last_id(before);
  check_ids_left(id, static_cast<std::size_t>(std::count_if(
                         rows.begin(), rows.end(), [](const Row& row) { return !row.is_old(); })));
  for (const Row& row : rows) {
    const bool old = row.is_old();
    const Sites& sites = row.of->sites;
    result.positions.push_back(sites.positions[row.k]);
    result.faces.push_back(sites.faces[row.k]);
    result.barycentric.push_back(sites.barycentric[row.k]);
    result.normals.push_back(old ? before.normals[row.given] : Vec3::Zero());
    result.ids.push_back(old ? before.ids[row.given] : static_cast<std::int32_t>(++id));
    result.classes.push_back(row.of->name);
    if (!before.fade.empty()) result.fade.push_back(old ? before.fade[row.given] : 1.0);
    moved.push_back(row.has_moved());
    if (!old || !row.has_moved()) continue;
    now.push_back(sites.positions[row.k]);
    then.push_back(carried.positions[row.given]);
  }
  renew_normals(surface, changed, moved, result);
  result.report = report_of(classes);
  result.report.count = result.size();
  result.report.spacing = surface.spacing(result.size());
  for (std::size_t c = 0; c < result.report.classes.size(); ++c) {
    const std::size_t count = static_cast<std::size_t>(
        std::count(classes[c].alive.begin(), classes[c].alive.end(), true));
    result.report.classes[c].count = count;
    result.report.classes[c].spacing = surface.spacing(count);
  }
  measure_slide(result.report, now, then);
  return result;
}

}  // namespace

Samples relax(const Surface& surface, const Samples& samples, std::span<const std::int32_t> changed,
              const RelaxOptions& options, Context* context) {
  TimedCall call(context);
  if (context) context->check();
  check(surface, samples, changed, options);
  const Sites before = carried(surface, samples, changed);
  std::optional<Samples> result = with_threads(options.threads, [&] {
    ClassRelaxation relaxation(surface, samples, before, changed, options);
    in_stage(call.context(), Stage::kStart, [&] { relaxation.run(call.context()); });
    if (!relaxation.has_relaxed()) return std::optional<Samples>();
    return std::optional(in_stage(call.context(), Stage::kReporting, [&] {
      Samples found = assemble(surface, samples, before, relaxation.classes(), changed);
      note_overlap(options, found);
      return found;
    }));
  });
  if (!result) return samples;
  call.write(result->report);
  if (context) context->advance(1.0);
  return std::move(*result);
}

std::vector<std::int32_t> changed_faces(const Surface& before, const Surface& after) {
  if (!before.same_faces(after))
    throw ArgumentError(
        "after has other faces than before: create it by deformed() or with_density()");
  std::vector<std::int32_t> result;
  for (const OrderedFace face : after.ordered().changed_faces(before.ordered()))
    result.push_back(after.ordered().original_face(face));
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace dapple
