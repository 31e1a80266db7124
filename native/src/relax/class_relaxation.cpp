// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/class_relaxation.hpp"

#include <algorithm>
#include <dapple/resample.hpp>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "relax/relaxation.hpp"
#include "sample/class_problem.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

using Indices = std::vector<std::int32_t>;

constexpr double kStill = 0.01;  // spacings of the union: smaller moves do not affect other classes

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

std::size_t wanted(const RelaxedClass& one) { return one.count.value_or(one.sites.size()); }

std::vector<OrderedFace> ordered_faces(const Surface& surface,
                                       std::span<const std::int32_t> faces) {
  std::vector<OrderedFace> result;
  result.reserve(faces.size());
  for (const std::int32_t face : faces) result.push_back(surface.ordered().counted_face(face));
  sort_unique(result);
  return result;
}

Indices all_faces(const Surface& surface) {
  Indices faces(surface.face_count());
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

/// Add a first site on each component without sites that has received a density.
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
  for (const auto& [component, face] : largest)
    if (mesh.geometry(face).moments.capacity > 0.0)
      append(sites, {{mesh.point(face, middle)}, {mesh.original_face(face)}, {middle}});
}

Sites left_of(const RelaxedClass& one) {
  Indices alive;
  for (std::size_t k = 0; k < one.sites.size(); ++k)
    if (one.alive[k]) alive.push_back(static_cast<std::int32_t>(k));
  return select(one.sites, alive);
}

Participant participant(const RelaxedClass& one) {
  return {&one.surface, static_cast<double>(wanted(one)) / one.surface.capacity(), one.radius};
}

/// The sites on the faces; those that were free when the class was relaxed alone stay free.
Region region_on(const RelaxedClass& one, std::span<const OrderedFace> faces, Context* context) {
  Region region{SurfacePart(one.surface, faces, context)};
  for (std::size_t k = 0; k < one.sites.size(); ++k) {
    const std::int32_t face = region.part.inside(one.sites.faces[k]);
    if (face >= 0 && one.alive[k])
      region.add({static_cast<std::int32_t>(k), !one.free[k], false, false}, one.sites, k, face);
  }
  return region;
}

}  // namespace

Report report_of(std::span<const RelaxedClass> classes) {
  Report result = classes.back().report;
  if (classes.size() < 2) return result;
  result = {};
  for (const RelaxedClass& one : classes) {
    result.evaluations += one.report.evaluations;
    result.iterations += one.report.iterations;
    result.converged = result.converged && one.report.converged;
    result.classes.push_back(one.report);
  }
  return result;
}

ClassRelaxation::ClassRelaxation(const Surface& surface, const Samples& samples, const Sites& sites,
                                 std::span<const std::int32_t> changed, const RelaxOptions& options)
    : options_(options), changed_(changed.begin(), changed.end()) {
  std::size_t count = 0;
  for (const SampleClass& one : options.classes) count += one.count;
  if (options.classes.empty()) count = options.count.value_or(samples.size());
  sides_ = with_sides(surface, count);
  if (options.classes.empty())
    add(samples.classes.empty() ? 0 : samples.classes[0], surface, options.count, 0.0);
  for (std::size_t c = 0; c < options.classes.size(); ++c) {
    const SampleClass& one = options.classes[c];
    add(static_cast<std::int32_t>(c), one.surface ? *one.surface : surface,
        options.free_counts ? std::nullopt : std::optional(one.count), one.radius);
  }
  deal_out(samples, sites);
}

void ClassRelaxation::add(std::int32_t name, const Surface& surface,
                          std::optional<std::size_t> count, double radius) {
  classes_.push_back({.name = name,
                      .surface = sides_ ? with_sides_of(*sides_, surface)->all : surface,
                      .count = count,
                      .radius = radius});
}

/// Distribute the samples to their classes.
void ClassRelaxation::deal_out(const Samples& samples, const Sites& sites) {
  std::vector<bool> locked(samples.size(), false);
  for (const std::int32_t k : options_.locked) locked[at(k)] = true;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    RelaxedClass& one = classes_[options_.classes.empty() ? 0 : at(samples.classes[k])];
    one.rows.push_back(static_cast<std::int32_t>(k));
    one.locked.push_back(locked[k]);
  }
  for (RelaxedClass& one : classes_) {
    one.sites = select(sites, one.rows);
    one.alive.resize(one.rows.size(), true);
    one.free.resize(one.rows.size(), false);
  }
}

void ClassRelaxation::run(Context* context) {
  std::vector<std::size_t> counts;
  counts.reserve(classes_.size());
  for (const RelaxedClass& one : classes_) counts.push_back(wanted(one));
  const std::vector<std::vector<std::size_t>> groups = groups_by_count(counts);
  done_.resize(classes_.size(), false);
  double begun = 0.0;
  for (const std::vector<std::size_t>& group : groups) {
    const double end =
        begun + static_cast<double>(group.size()) / static_cast<double>(classes_.size());
    Stretch alone(context, begun, group.size() > 1 ? std::midpoint(begun, end) : end);
    Stretch together(context, std::midpoint(begun, end), end);
    for (const std::size_t c : group) {
      relax(c, alone.context());
      done_[c] = true;
    }
    if (group.size() > 1) relax_together(group, together.context());
    begun = end;
  }
}

/// The changed faces and the faces of samples on density 0; all faces if only the count changes.
std::vector<OrderedFace> ClassRelaxation::faces_to_relax(const RelaxedClass& one) const {
  Indices faces = changed_;
  if (faces.empty() && one.count && *one.count != one.sites.size()) faces = all_faces(one.surface);
  if (!one.surface.uniform())
    for (std::size_t k = 0; k < one.sites.size(); ++k)
      if (!one.locked[k] &&
          !is_on_density(one.surface, one.sites.faces[k], one.sites.barycentric[k]))
        faces.push_back(one.sites.faces[k]);
  return ordered_faces(one.surface, faces);
}

/// The given classes, and others with at most about as many samples; more frequent classes adapt
/// later.
Participants ClassRelaxation::participants_of(std::span<const std::size_t> group) const {
  Participants participants{{}, {}, options_.union_weight};
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::size_t c : group) {
    participants.relaxed.push_back(participant(classes_[c]));
    least = std::min(least, wanted(classes_[c]));
  }
  for (std::size_t k = 0; k < classes_.size(); ++k) {
    if (std::find(group.begin(), group.end(), k) != group.end() || wanted(classes_[k]) == 0 ||
        (!done_[k] &&
         static_cast<double>(wanted(classes_[k])) >= kRarer * static_cast<double>(least)))
      continue;
    participants.fixed.push_back(participant(classes_[k]));
    participants.fixed.back().sites = left_of(classes_[k]);
  }
  return participants;
}

/// Create the first samples of a class without samples.
void ClassRelaxation::begin(RelaxedClass& one, std::size_t count, Context* context) const {
  const Samples found = resample(one.surface, {}, count,
                                 {.seed = options_.seed, .optimizer = options_.optimizer}, context);
  one.sites = {found.positions, found.faces, found.barycentric};
  one.locked.resize(found.size(), false);
  one.alive.resize(found.size(), true);
  one.free.resize(found.size(), true);
  one.report = found.report;
}

void ClassRelaxation::relax(std::size_t c, Context* context) {
  RelaxedClass& one = classes_[c];
  std::vector<OrderedFace> faces = faces_to_relax(one);
  if (one.sites.size() == 0) {
    if (!one.count || *one.count == 0) return;
    relaxed_ = true;
    begin(one, *one.count, context);
    if (classes_.size() == 1) return;
    faces = ordered_faces(one.surface, all_faces(one.surface));
  }
  if (faces.empty()) return;
  relaxed_ = true;
  const Sites before = one.sites;
  settle_components(one.surface, faces, one.sites);
  one.locked.resize(one.sites.size(), false);
  const Participants participants = participants_of({&c, 1});
  const RelaxOptions options{
      .seed = options_.seed, .optimizer = options_.optimizer, .count = one.count};
  Relaxation relaxation(one.surface, one.sites, one.locked, options,
                        classes_.size() > 1 ? &participants : nullptr);
  relaxation.run(faces, context);
  one.sites = relaxation.sites();
  one.faces = relaxation.faces();
  one.report = relaxation.report();
  one.alive.clear();
  one.free.clear();
  for (std::size_t k = 0; k < one.sites.size(); ++k) {
    one.alive.push_back(relaxation.is_alive(k));
    one.free.push_back(relaxation.is_free(k));
  }
  note_moves(one, before);
}

/// Relax classes together. Before, each class has found its number of samples and their approximate
/// positions one after another, and the last one had to use the space that the others had left.
void ClassRelaxation::relax_together(std::span<const std::size_t> group, Context* context) {
  std::vector<OrderedFace> faces;
  for (const std::size_t c : group) {
    const std::vector<OrderedFace>& more = classes_[c].faces;
    const std::vector<OrderedFace> before = std::exchange(faces, {});
    std::set_union(before.begin(), before.end(), more.begin(), more.end(),
                   std::back_inserter(faces));
  }
  if (faces.empty()) return;
  std::vector<Region> regions;
  for (const std::size_t c : group) regions.push_back(region_on(classes_[c], faces, context));
  std::vector<FreeClass> free_classes;
  const Participants participants = participants_of(group);
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto& domain = regions[k].part.domain();
    free_classes.push_back(
        {&regions[k], domain, domain->density_unit() / participants.relaxed[k].weight});
  }
  const Minimum found = minimize_free(free_classes, participants, options_.optimizer, context);
  store(group, free_classes, found);
}

void ClassRelaxation::store(std::span<const std::size_t> group,
                            std::span<const FreeClass> free_classes, const Minimum& found) {
  const std::vector<Part>& parts = found.state.parts;
  std::size_t first = 0, part = parts.size() > 1 ? 1 : 0;  // that of the union comes first
  for (std::size_t k = 0; k < group.size(); ++k) {
    RelaxedClass& one = classes_[group[k]];
    const Region& region = *free_classes[k].region;
    const std::vector<bool> free = region.free();
    const Sites before = one.sites;
    region.put_free(found.state.sites, first, one.sites);
    if (std::ranges::find(free, true) != free.end()) {  // others have no part
      const std::span<const Vec3> normals(found.state.normals);
      measure_members({parts[part].energy.diagram, normals.subspan(first, free.size()), free,
                       free_classes[k].share, options_.optimizer.capacity_weight},
                      one.report);
      ++part;
    }
    first += free.size();
    note_moves(one, before);
  }
  RelaxedClass& last = classes_[group.back()];
  last.report.evaluations += found.evaluations;
  last.report.iterations += found.iterations;
  last.report.converged = found.converged;
}

/// Note where samples have appeared, vanished or moved, so that other classes adapt.
void ClassRelaxation::note_moves(const RelaxedClass& one, const Sites& before) {
  std::size_t count = 0;
  for (const RelaxedClass& each : classes_) count += each.count.value_or(each.sites.size());
  const double still = kStill * one.surface.spacing(count);
  for (std::size_t k = 0; k < one.sites.size(); ++k) {
    const bool old = k < one.rows.size();
    if (old && one.alive[k] && (one.sites.positions[k] - before.positions[k]).norm() <= still)
      continue;
    if (!old && !one.alive[k]) continue;
    if (old) changed_.push_back(before.faces[k]);
    if (one.alive[k]) changed_.push_back(one.sites.faces[k]);
  }
}

}  // namespace dapple
