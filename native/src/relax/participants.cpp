// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/participants.hpp"

#include <algorithm>

#include "optimize/discs.hpp"
#include "rebalance/lead_to_density.hpp"
#include "sample/solve_classes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kOverlap = 1e-3;  // of the wanted distance: smaller overlaps are accepted

std::vector<const Participant*> all_of(const Participants& participants) {
  std::vector<const Participant*> result;
  result.reserve(participants.relaxed.size() + participants.fixed.size());
  for (const Participant& one : participants.relaxed) result.push_back(&one);
  for (const Participant& one : participants.fixed) result.push_back(&one);
  return result;
}

/// The part with the sum of the classes' densities, and the capacity per site on it.
struct UnionPart {
  Surface surface;
  double share;
};

UnionPart union_on(const SurfacePart& part, const Participants& participants) {
  const std::vector<const Participant*> all = all_of(participants);
  double weights = 0.0;
  for (const Participant* one : all) weights += one->weight;
  if (std::all_of(all.begin(), all.end(), [](const auto* one) { return one->surface->uniform(); }))
    return {part.surface(), 1.0 / weights};
  std::vector<double> values;
  for (std::size_t f = 0; f < part.surface().face_count(); ++f) {
    Vec3 sum = Vec3::Zero();
    for (const Participant* one : all) {
      const OrderedSurface& mesh = one->surface->ordered();
      const std::int32_t face = part.outside(static_cast<std::int32_t>(f));
      sum += one->weight * mesh.densities(mesh.ordered_face(face));
    }
    values.insert(values.end(), {sum[0], sum[1], sum[2]});
  }
  return {part.surface().with_density({DensityAt::kCorners, values}), 1.0};
}

/// The samples on the part, with the part's face indices.
Sites on_part(const SurfacePart& part, const Sites& sites) {
  std::vector<std::int32_t> inside;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (part.inside(sites.faces[k]) >= 0) inside.push_back(static_cast<std::int32_t>(k));
  Sites result = select(sites, inside);
  for (std::int32_t& face : result.faces) face = part.inside(face);
  return result;
}

/// Classes on the part, the relaxed ones first, with their capacities.
struct Gathered {
  ClassProblem problem;
  Sites start;
  std::vector<bool> locked;
};

Gathered gather(std::span<const FreeClass> free_classes, const Participants& participants) {
  Gathered result;
  std::vector<ClassProblem::Member>& classes = result.problem.classes;
  for (std::size_t c = 0; c < free_classes.size(); ++c) {
    const Region& region = *free_classes[c].region;
    classes.push_back({.domain = free_classes[c].domain,
                       .count = region.members.size(),
                       .radius = participants.relaxed[c].radius,
                       .site_capacity = free_classes[c].share});
    Sites own = region.sites;
    const std::vector<bool> fixed = region.fixed();
    lead_to_density(region.part.surface(), *free_classes[c].domain, own, fixed);
    append(result.start, own);
    result.locked.insert(result.locked.end(), fixed.begin(), fixed.end());
  }
  for (const Participant& other : participants.fixed) {
    const Sites around = on_part(free_classes[0].region->part, other.sites);
    classes.push_back({classes[0].domain, around.size(), other.radius});
    append(result.start, around);
    result.locked.resize(result.start.size(), true);
  }
  return result;
}

}  // namespace

bool discs_overlap(const Region& region, const Participants& participants) {
  Sites sites = region.sites;
  std::vector<double> radii(sites.size(), participants.relaxed[0].radius);
  for (const Participant& other : participants.fixed) {
    append(sites, on_part(region.part, other.sites));
    radii.resize(sites.size(), other.radius);
  }
  if (std::all_of(radii.begin(), radii.end(), [](double radius) { return radius == 0.0; }))
    return false;
  Vectors normals;
  const OrderedSurface& mesh = region.part.surface().ordered();
  for (const std::int32_t face : sites.faces)
    normals.push_back(mesh.geometry(mesh.ordered_face(face)).normal);
  return worst_overlap(evaluate_disc_repulsion({sites, normals, radii}, 1.0)) > kOverlap;
}

Minimum minimize_free(std::span<const FreeClass> free_classes, const Participants& participants,
                      const OptimizerOptions& options, Context* context) {
  Gathered gathered = gather(free_classes, participants);
  ClassProblem& problem = gathered.problem;
  const UnionPart union_part = union_on(free_classes[0].region->part, participants);
  problem.all = problem.classes[0].domain;
  problem.site_capacity = problem.classes[0].site_capacity;
  if (gathered.start.size() > problem.classes[0].count) {
    problem.all = domain_of(union_part.surface);
    problem.site_capacity = union_part.share * problem.all->density_unit();
  }
  Objective objective =
      make_objective(problem, class_of_sites(problem),
                     {.union_weight = participants.union_weight, .sample = {.optimizer = options}},
                     std::move(gathered.locked));
  leave_out_locked(objective);
  objective.holds_discs = !objective.discs.empty();
  return solve(std::move(objective), gathered.start, options, context).minimum;
}

}  // namespace dapple
