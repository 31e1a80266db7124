// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/gauss_newton.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"

namespace dapple {
namespace {

constexpr double kSolverTolerance =
    1e-2;                            // of the residual: the step is shortened and corrected anyway
constexpr double kLeastMass = 1e-3;  // of the mean: keeps empty cells from making H singular
constexpr double kStiff = 10.0;      // of a contact, in units of the mean diagonal
constexpr std::size_t kGrain = 1024;

double mean_mass(const RestrictedVoronoi& diagram) {
  double sum = 0.0;
  for (const Moments& cell : diagram.cells) sum += cell.mass;
  return sum / static_cast<double>(std::max<std::size_t>(diagram.cells.size(), 1));
}

std::size_t site_of(const Term& term, std::size_t member) {
  return term.members.empty() ? member : static_cast<std::size_t>(term.members[member]);
}

/// Call visit(i, j, pair, scale) for every repelling pair, with the indices of its sites.
template <typename Visit>
void for_each_pair(const Objective& objective, const Evaluation& state, const Visit& visit) {
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const Term& term = objective.terms[t];
    const double scale = objective.scale(t, state.parts[t].energy.gradient.size());
    for (const ClosePair& pair : state.parts[t].repulsion.pairs)
      visit(site_of(term, static_cast<std::size_t>(pair.i)),
            site_of(term, static_cast<std::size_t>(pair.j)), pair, scale);
  }
  for (const ClosePair& pair : state.discs.pairs)
    visit(static_cast<std::size_t>(pair.i), static_cast<std::size_t>(pair.j), pair, 1.0);
}

double largest(const Vectors& v) {
  double most = 0.0;
  for (const Vec3& x : v) most = std::max(most, x.cwiseAbs().maxCoeff());
  return most;
}

/// The mean diagonal of the first term with positive weight.
double unit_of(const Objective& objective, const Evaluation& state) {
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const RestrictedVoronoi& diagram = state.parts[t].energy.diagram;
    const double unit = 2.0 * objective.scale(t, diagram.cells.size()) * mean_mass(diagram);
    if (unit > 0.0) return unit;
  }
  return 1.0;
}

}  // namespace

// All values are divided by the mean of the diagonal, so that they are of order 1 in any units.
void GaussNewton::update(const Objective& objective, const Evaluation& state, int steps,
                         const Context* context) {
  steps_ = steps;
  context_ = context;
  unit_ = unit_of(objective, state);
  locked_ = objective.locked;
  contacts_.sides.clear();
  bases_.resize(state.normals.size());
  for_each_vector(bases_.size(),
                  [&](std::size_t k) { bases_[k] = tangent_basis(state.normals[k]); });
  add_masses(objective, state);
  terms_.resize(state.parts.size());
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    if (context_) context_->check();
    const RestrictedVoronoi& diagram = state.parts[t].energy.diagram;
    const double scale = objective.scale(t, diagram.cells.size());
    terms_[t].update(diagram, objective.terms[t].members, bases_,
                     std::sqrt(2.0 * objective.capacity_weight * scale / unit_));
  }
  add_pairs(objective, state);
  add_boundaries(objective, state);
  add_blocks();
}

void GaussNewton::add_masses(const Objective& objective, const Evaluation& state) {
  masses_.assign(state.sites.size(), 0.0);
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const std::vector<Moments>& cells = state.parts[t].energy.diagram.cells;
    const double factor = 2.0 * objective.scale(t, cells.size()) / unit_;
    const double least = kLeastMass * mean_mass(state.parts[t].energy.diagram);
    for (std::size_t k = 0; k < cells.size(); ++k)
      masses_[site_of(objective.terms[t], k)] += factor * std::max(cells[k].mass, least);
  }
  anchoring_ = &objective.anchoring;
  held_.resize(anchoring_->empty() ? 0 : masses_.size());
  for_each_vector(held_.size(),
                  [&](std::size_t k) { held_[k] = 2.0 * anchoring_->stiffness(k) / unit_; });
}

void GaussNewton::add_pairs(const Objective& objective, const Evaluation& state) {
  std::vector<std::size_t> next = pairs_.lay_out(state.sites.size(), [&](const auto& visit) {
    for_each_pair(objective, state,
                  [&](std::size_t i, std::size_t j, const ClosePair&, double) { visit(i, j); });
  });
  for_each_pair(objective, state,
                [&](std::size_t i, std::size_t j, const ClosePair& pair, double scale) {
                  const double root = std::sqrt(scale * pair.stiffness / unit_);
                  const Tangent at_i = to_tangent(bases_[i], pair.direction, root);
                  const Tangent at_j = to_tangent(bases_[j], pair.direction, root);
                  pairs_.sides[next[i]++] = {static_cast<std::int32_t>(j), at_i, at_j};
                  pairs_.sides[next[j]++] = {static_cast<std::int32_t>(i), at_j, at_i};
                });
}

void GaussNewton::hold(std::span<const Contact> contacts, Vectors& b) {
  std::vector<std::size_t> next = contacts_.lay_out(masses_.size(), [&](const auto& visit) {
    for (const Contact& contact : contacts) visit(contact.i, contact.j);
  });
  const double root = std::sqrt(kStiff);
  for (const Contact& contact : contacts) {
    const auto [i, j] = std::pair(contact.i, contact.j);
    const Tangent at_i = to_tangent(bases_[i], contact.at_i, root);
    const Tangent at_j = to_tangent(bases_[j], contact.at_j, root);
    contacts_.sides[next[i]++] = {static_cast<std::int32_t>(j), at_i, at_j};
    contacts_.sides[next[j]++] = {static_cast<std::int32_t>(i), at_j, at_i};
    blocks_[i].add_square(at_i);
    blocks_[j].add_square(at_j);
    b[i] += unit_ * kStiff * contact.gap * contact.at_i;
    b[j] -= unit_ * kStiff * contact.gap * contact.at_j;
  }
}

void GaussNewton::add_boundaries(const Objective& objective, const Evaluation& state) {
  boundaries_.resize(objective.has_curved_cvt() ? state.parts.size() : 0);
  boundary_blocks_.assign(boundaries_.empty() ? 0 : masses_.size(), {});
  for (std::size_t t = 0; t < boundaries_.size(); ++t) {
    const RestrictedVoronoi& diagram = state.parts[t].energy.diagram;
    BoundaryCurvature& term = boundaries_[t];
    term.update(diagram, objective.terms[t].members, bases_,
                objective.scale(t, diagram.cells.size()) / unit_);
    for_each_vector(term.cells(),
                    [&](std::size_t k) { boundary_blocks_[term.site(k)] += term.block(k); });
  }
}

void GaussNewton::add_blocks() {
  blocks_.assign(masses_.size(), {});
  for (const CapacityJacobian& term : terms_) term.add_blocks(blocks_);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    for (const Side& side : pairs_.of(k)) blocks_[k].add_square(side.own);
    if (held_.empty()) continue;
    blocks_[k].uu += held_[k];
    blocks_[k].vv += held_[k];
  }
}

Tangent GaussNewton::pull_of_neighbors(std::size_t k) const {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t neighbor : anchoring_->neighbors(k)) {
    const auto j = static_cast<std::size_t>(neighbor);
    sum += anchoring_->stiffness(k, j) * in_space_[j];
  }
  return to_tangent(bases_[k], sum, 2.0 / unit_);
}

void GaussNewton::apply(const TangentVectors& v, const Trust& trust, TangentVectors& result) {
  const bool subtracts = subtracts_boundaries(trust);
  const bool ties = anchoring_->ties_neighbors();
  in_space_.resize(ties ? v.size() : 0);
  for_each_vector(in_space_.size(),
                  [&](std::size_t k) { in_space_[k] = to_space(bases_[k], v[k], 1.0); });
  parallel_chunks(v.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Tangent sum = (trust.delta * masses_[k] + (held_.empty() ? 0.0 : held_[k])) * v[k];
      if (ties) sum += -pull_of_neighbors(k);
      for (const Springs* springs : {&pairs_, &contacts_})
        for (const Side& side : springs->of(k))
          sum += (side.own.dot(v[k]) - side.others.dot(v[static_cast<std::size_t>(side.other)])) *
                 side.own;
      if (subtracts) sum += -boundaries_[0].product(v, k, trust.boundaries);
      result[k] = sum;
    }
  });
  for (std::size_t t = 1; subtracts && t < boundaries_.size(); ++t)
    parallel_chunks(boundaries_[t].cells(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        result[boundaries_[t].site(k)] += -boundaries_[t].product(v, k, trust.boundaries);
    });
  for (const CapacityJacobian& term : terms_) term.add_product(v, change_, result);
}

void GaussNewton::precondition(const Trust& trust) {
  const bool subtracts = subtracts_boundaries(trust);
  inverse_.resize(blocks_.size());
  for_each_vector(inverse_.size(), [&](std::size_t k) {
    const bool locked = !locked_.empty() && locked_[k];
    TangentBlock block = blocks_[k];
    if (subtracts) block -= trust.boundaries * boundary_blocks_[k];
    inverse_[k] = locked ? TangentBlock() : block.inverse(trust.delta * masses_[k]);
  });
}

Vectors GaussNewton::solve(const Vectors& b, const Trust& trust) {
  Vectors result(b.size(), Vec3::Zero());
  const double size = largest(b);
  if (!(size > 0.0)) return result;
  residual_.resize(b.size());
  for_each_vector(b.size(),
                  [&](std::size_t k) { residual_[k] = to_tangent(bases_[k], b[k], 1.0 / size); });
  precondition(trust);
  iterate(trust);
  const double back = size / unit_;
  for_each_vector(b.size(), [&](std::size_t k) { result[k] = to_space(bases_[k], x_[k], back); });
  return result;
}

void GaussNewton::iterate(const Trust& trust) {
  const std::size_t count = residual_.size();
  TangentVectors &x = x_, &z = preconditioned_;
  x.resize(count);
  z.resize(count);
  direction_.resize(count);
  applied_.resize(count);
  for_each_vector(count, [&](std::size_t k) {
    x[k] = {};
    direction_[k] = z[k] = inverse_[k] * residual_[k];
  });
  double rho = dot(residual_, z);
  indefinite_ = !(rho > 0.0);
  const double enough = kSolverTolerance * kSolverTolerance * rho;
  for (int step = 0; step < steps_ && rho > enough; ++step) {
    if (context_) context_->check();
    apply(direction_, trust, applied_);
    const double curvature = dot(direction_, applied_);
    indefinite_ = !(curvature > 0.0);
    if (indefinite_) break;
    const double length = rho / curvature;
    for_each_vector(count, [&](std::size_t k) {
      x[k] += length * direction_[k];
      residual_[k] += -length * applied_[k];
      z[k] = inverse_[k] * residual_[k];
    });
    const double next = dot(residual_, z);
    const double ratio = next / rho;
    for_each_vector(count, [&](std::size_t k) { direction_[k] = z[k] + ratio * direction_[k]; });
    rho = next;
  }
}

}  // namespace dapple
