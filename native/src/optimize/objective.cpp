// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/objective.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "optimize/energy.hpp"
#include "voronoi/local_spacing.hpp"

namespace dapple {
namespace {

constexpr double kHexagon = 3.4641016151377544;  // area around a circle of radius 1: 2 sqrt 3
constexpr double kMostRoom = 0.5;  // share of other sites' capacity that large discs may take

/// kappa (|S|_phi / n)^2
double repulsion_weight(const Term& term, std::size_t count) {
  const double share = term.mean_capacity(count);
  return term.repulsion_weight * share * share;
}

void add(const Objective& objective, std::size_t term, const Part& part, Evaluation& state) {
  const std::vector<std::int32_t>& members = objective.terms[term].members;
  const double scale = objective.scale(term, part.energy.gradient.size());
  const double relief = 1.0 - objective.cvt_weight;
  state.total += scale * (part.energy.total - relief * part.energy.cvt + part.repulsion.energy);
  for_each_vector(part.energy.gradient.size(), [&](std::size_t k) {
    state.gradient[members.empty() ? k : static_cast<std::size_t>(members[k])] +=
        scale * (part.energy.gradient[k] + 2.0 * relief * part.energy.diagram.cells[k].first +
                 part.repulsion.gradient[k]);
  });
}

/// Add the part of lambda (sum (m_i - t_i)^2 + |S|_phi^2 / n) that depends on the target capacities
/// t_i.
void add_wanted(const Objective& objective, std::size_t term, const Part& part, Evaluation& state) {
  const Term& of = objective.terms[term];
  if (of.wanted.empty()) return;
  const RestrictedVoronoi& diagram = part.energy.diagram;
  const double weight = objective.scale(term, diagram.cells.size()) * objective.capacity_weight;
  const double capacity = of.capacity(diagram.cells.size());
  double sum = capacity * capacity / static_cast<double>(diagram.cells.size());
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) {
    sum += of.wanted[i] * (of.wanted[i] - 2.0 * diagram.cells[i].capacity);
    Vec3 more = Vec3::Zero();
    for (const CellBoundary& side : diagram.boundary(i))
      more += (of.wanted[i] - of.wanted[static_cast<std::size_t>(side.neighbor)]) * side.flux;
    state.gradient[of.members.empty() ? i : static_cast<std::size_t>(of.members[i])] -=
        2.0 * weight * more;
  }
  state.total += weight * sum;
}

void add_anchoring(const Anchoring& anchoring, Evaluation& state) {
  if (anchoring.empty()) return;
  const Vectors& positions = state.sites.positions;
  for (std::size_t k = 0; k < positions.size(); ++k) state.total += anchoring.energy(positions, k);
  for_each_vector(positions.size(),
                  [&](std::size_t k) { state.gradient[k] += anchoring.gradient(positions, k); });
}

void add_up(const Objective& objective, Evaluation& state) {
  state.total = state.discs.energy;
  state.gradient.resize(state.sites.size());
  for_each_vector(state.gradient.size(), [&](std::size_t k) { state.gradient[k].setZero(); });
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    add(objective, t, state.parts[t], state);
    add_wanted(objective, t, state.parts[t], state);
  }
  if (!state.discs.pairs.empty()) add_scaled(state.gradient, 1.0, state.discs.gradient);
  add_anchoring(objective.anchoring, state);
  objective.restrict(state.gradient, state.normals);
}

/// The local spacing at each site of a term.
std::vector<double> local_spacings(const Objective& objective, const Part& part, std::size_t term) {
  const std::vector<Moments>& cells = part.energy.diagram.cells;
  const double capacity = objective.terms[term].mean_capacity(cells.size());
  std::vector<double> result;
  result.reserve(cells.size());
  for (const Moments& cell : cells) result.push_back(local_spacing(cell, capacity));
  return result;
}

/// Evaluate the repulsion at the current radii and add up the terms again.
void repel(const Objective& objective, Evaluation& state) {
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    Part& part = state.parts[t];
    const Term& term = objective.terms[t];
    update_repulsion(part.repulsion, part.energy.diagram, term.radii,
                     repulsion_weight(term, part.energy.gradient.size()), part.strangers,
                     objective.strangers_weight);
  }
  add_up(objective, state);
}

}  // namespace

double Objective::total_weight() const {
  double sum = 0.0;
  for (const Term& term : terms) sum += term.weight;
  return sum;
}

double Objective::scale(std::size_t term, std::size_t sites) const {
  const double capacity = terms[term].capacity(sites);
  return terms[term].weight * static_cast<double>(sites) / capacity / capacity;
}

Sites Objective::project(const Vectors& points, std::span<const std::int32_t> hints,
                         std::span<const std::int32_t> which, const Context* context) const {
  const StageSpan projecting(context, Stage::kProjection);
  if (mirror && which.empty()) return mirror->project(domain(), points, hints, context);
  if (homes.size() < 2)
    return (homes.empty() ? domain() : *homes[0]).project(points, hints, context);
  Sites result{points, {hints.begin(), hints.end()}, Vectors(points.size())};
  for (std::size_t c = 0; c < homes.size(); ++c) {
    std::vector<std::int32_t> members;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (classes[which.empty() ? k : static_cast<std::size_t>(which[k])] ==
          static_cast<std::int32_t>(c))
        members.push_back(static_cast<std::int32_t>(k));
    const Sites mine = select(result, members);
    const Sites found = homes[c]->project(mine.positions, mine.faces, context);
    put(result, members, found);
  }
  return result;
}

std::vector<std::int32_t> Objective::move(const Vectors& moves, Sites& sites,
                                          const Context* context) const {
  std::vector<std::int32_t> moved;
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (moves[k].squaredNorm() > 0.0) moved.push_back(static_cast<std::int32_t>(k));
  Sites some = select(sites, moved);
  for (std::size_t k = 0; k < moved.size(); ++k)
    some.positions[k] += moves[static_cast<std::size_t>(moved[k])];
  put(sites, moved, project(some.positions, some.faces, moved, context));
  return moved;
}

void Objective::restrict(Vectors& v, const Vectors& normals) const {
  make_tangential(v, normals);
  if (mirror) mirror->restrict(v, normals);
  if (locked.empty()) return;
  for (std::size_t k = 0; k < v.size(); ++k)
    if (locked[k]) v[k].setZero();
}

Evaluation evaluate(const Objective& objective, Sites sites, Context* context) {
  Evaluation state;
  update(state, objective, std::move(sites), context);
  return state;
}

void update(Evaluation& state, const Objective& objective, Sites sites, Context* context) {
  state.sites = std::move(sites);
  objective.domain().check(state.sites);
  update_normals(state, objective);
  state.parts.resize(objective.terms.size());
  for (std::size_t t = 0; t < objective.terms.size(); ++t) {
    const Term& term = objective.terms[t];
    Part& part = state.parts[t];
    Stretch evaluating(context, t, objective.terms.size());
    if (!term.members.empty()) select(state.sites, term.members, part.sites);
    const Sites& mine = term.members.empty() ? state.sites : part.sites;
    in_stage(evaluating.context(), Stage::kCells, [&] {
      term.domain->update_cells(part.energy.diagram, mine, t, evaluating.context());
    });
    sum_up(part.energy, term.capacity(mine.size()), objective.capacity_weight);
    if (term.domain->has_bodies() && term.repulsion_weight > 0.0)
      part.strangers = find_strangers(*term.domain, mine, part.energy.diagram,
                                      local_spacings(objective, part, t));
  }
  state.discs = {};
  if (!objective.discs.empty())
    state.discs = evaluate_disc_repulsion(discs_of(objective, state), objective.discs_weight);
  repel(objective, state);
}

void update_normals(Evaluation& state, const Objective& objective) {
  state.normals.resize(state.sites.size());
  for_each_vector(state.normals.size(), [&](std::size_t k) {
    state.normals[k] = objective.domain().normal(state.sites.faces[k]);
  });
}

Discs discs_of(const Objective& objective, const Evaluation& state) {
  return {state.sites, state.normals, objective.discs, objective.domain().period()};
}

void check_finite_energy(const Objective& objective, const Evaluation& state) {
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const Energy& energy = state.parts[t].energy;
    check_finite_energy(energy.total, energy.diagram.cells, objective.terms[t].members);
  }
}

double local_spacing(const Objective& objective, const Evaluation& state, std::size_t term,
                     std::size_t k) {
  const std::vector<Moments>& cells = state.parts[term].energy.diagram.cells;
  return local_spacing(cells[k], objective.terms[term].mean_capacity(cells.size()));
}

double spacing_between(const Objective& objective, const Evaluation& state, std::size_t i,
                       std::size_t j) {
  return 0.5 * (local_spacing(objective, state, 0, i) + local_spacing(objective, state, 0, j));
}

void shrink_radii(Objective& objective, Evaluation& state) {
  bool changed = false;
  for (std::size_t t = 0; t < objective.terms.size(); ++t) {
    Term& term = objective.terms[t];
    if (term.repulsion_weight == 0.0 || (term.domain->uniform() && !term.radii.empty())) continue;
    term.radii.resize(state.parts[t].energy.gradient.size(), kInfinite);
    for (std::size_t k = 0; k < term.radii.size(); ++k)
      term.radii[k] =
          std::min(term.radii[k], term.repulsion_radius * local_spacing(objective, state, t, k));
    changed = true;
  }
  if (changed) repel(objective, state);
}

std::vector<double> energy_shares(const Objective& objective, const Evaluation& state) {
  std::vector<double> shares(state.sites.size(), 0.0);
  const auto add_pairs = [&](const Repulsion& repulsion, const auto& site, double scale) {
    for (const ClosePair& pair : repulsion.pairs)
      for (const std::int32_t end : {pair.i, pair.j})
        shares[site(end)] += 0.5 * scale * pair.energy;
  };
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const std::vector<Moments>& cells = state.parts[t].energy.diagram.cells;
    const std::vector<std::int32_t>& members = objective.terms[t].members;
    const auto site = [&](std::int32_t k) {
      return static_cast<std::size_t>(members.empty() ? k : members[static_cast<std::size_t>(k)]);
    };
    const double scale = objective.scale(t, cells.size());
    const double mean = objective.terms[t].mean_capacity(cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::vector<double>& wanted = objective.terms[t].wanted;
      const double excess = cells[k].capacity - (wanted.empty() ? mean : wanted[k]);
      shares[site(static_cast<std::int32_t>(k))] +=
          scale *
          (objective.cvt_weight * cells[k].second + objective.capacity_weight * excess * excess);
    }
    add_pairs(state.parts[t].repulsion, site, scale);
  }
  add_pairs(state.discs, [](std::int32_t k) { return static_cast<std::size_t>(k); }, 1.0);
  if (!objective.anchoring.empty())
    for (std::size_t k = 0; k < shares.size(); ++k)
      shares[k] += objective.anchoring.energy(state.sites.positions, k);
  return shares;
}

double normalized_energy(const Objective& objective, const Evaluation& state) {
  double sum = 0.0;
  for (std::size_t t = 0; t < state.parts.size(); ++t)
    sum += objective.terms[t].weight * state.parts[t].energy.normalized;
  return sum / objective.total_weight();
}

double normalized_cvt(const Objective& objective, const Evaluation& state) {
  double sum = 0.0;
  for (std::size_t t = 0; t < state.parts.size(); ++t)
    sum += objective.scale(t, state.parts[t].energy.gradient.size()) * state.parts[t].energy.cvt /
           std::pow(owned_share(objective, state, t), 2);
  return sum / objective.total_weight();
}

double owned_share(const Objective& objective, const Evaluation& state, std::size_t term) {
  const RestrictedVoronoi& diagram = state.parts[term].energy.diagram;
  return owned_share(diagram, objective.terms[term].capacity(diagram.cells.size()));
}

double capacity_variation(const Objective& objective, const Evaluation& state) {
  const double rest = normalized_energy(objective, state) - normalized_cvt(objective, state);
  return objective.capacity_weight > 0.0
             ? std::sqrt(std::max(0.0, rest) / objective.capacity_weight)
             : 0.0;
}

void anchor(Objective& objective, Evaluation& state, Vectors anchors, const Hold& hold) {
  const double scale = objective.scale(0, anchors.size());
  objective.anchoring = Anchoring(state.diagram(), std::move(anchors), scale, hold);
  add_up(objective, state);
}

// Every other site is farther from a disc's center than the disc's radius plus the smallest radius,
// so the cell contains the hexagon around a circle with half of this distance as radius. If the
// smallest radius is 0, points may be close together.
void give_room(Objective& objective, Evaluation& state) {
  if (objective.discs.empty()) return;
  const double least = *std::min_element(objective.discs.begin(), objective.discs.end());
  const std::vector<Moments>& cells = state.diagram().cells;
  const double mean = objective.terms[0].mean_capacity(cells.size());
  std::vector<double> wanted(cells.size(), mean);
  double more = 0.0, others = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const double inside = 0.5 * (objective.discs[k] + least);
    const double density = cells[k].area > 0.0 ? cells[k].capacity / cells[k].area : 0.0;
    wanted[k] = std::max(mean, kHexagon * inside * inside * density);
    more += wanted[k] - mean;
    others += wanted[k] > mean ? 0.0 : 1.0;
  }
  if (more == 0.0 || more > kMostRoom * others * mean) return;
  for (double& capacity : wanted)
    if (capacity == mean) capacity -= more / others;
  objective.terms[0].wanted = std::move(wanted);
  add_up(objective, state);
}

void weigh_cvt(Objective& objective, Evaluation& state, double weight) {
  objective.cvt_weight = weight;
  add_up(objective, state);
}

}  // namespace dapple
