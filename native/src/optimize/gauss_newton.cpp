// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/gauss_newton.hpp"

#include <Eigen/Dense>
#include <numeric>

#include "base/parallel.hpp"
#include "base/tangent_basis.hpp"

namespace dapple {
namespace {

constexpr double kSolverTolerance =
    1e-2;  // of the residual: the step is shortened and corrected anyway
constexpr std::size_t kGrain = 1024;

void add_pairs(const Repulsion& repulsion, const Vectors& v, Vectors& result) {
  for (const ClosePair& pair : repulsion.pairs) {
    const auto i = static_cast<std::size_t>(pair.i);
    const auto j = static_cast<std::size_t>(pair.j);
    const Vec3 force = pair.stiffness * pair.direction.dot(v[i] - v[j]) * pair.direction;
    result[i] += force;
    result[j] -= force;
  }
}

void add_pair_blocks(const Repulsion& repulsion, std::vector<Eigen::Matrix3d>& blocks) {
  for (const ClosePair& pair : repulsion.pairs) {
    const Eigen::Matrix3d block = pair.stiffness * pair.direction * pair.direction.transpose();
    blocks[static_cast<std::size_t>(pair.i)] += block;
    blocks[static_cast<std::size_t>(pair.j)] += block;
  }
}

}  // namespace

// ---- one term ----

GaussNewtonPart::GaussNewtonPart(const Part& part, const std::vector<std::int32_t>& members,
                                 double capacity_weight, double scale)
    : part_(part),
      diagram_(part.energy.diagram),
      members_(members),
      capacity_weight_(capacity_weight),
      scale_(scale) {
  double mass = 0.0;
  for (const Moments& cell : diagram_.cells) mass += cell.mass;
  least_mass_ = 1e-3 * mass / static_cast<double>(std::max<std::size_t>(diagram_.cells.size(), 1));
  own_.assign(diagram_.cells.size(), Vec3::Zero());
  for (std::size_t i = 0; i < own_.size(); ++i)
    for (const CellBoundary& side : diagram_.boundary(i)) own_[i] += side.flux;
  transpose();
}

// J needs a_ji in row i, and the cells list a_ij: gathering instead of scattering lets the rows run
// in parallel.
void GaussNewtonPart::transpose() {
  const std::size_t count = diagram_.cells.size();
  starts_.assign(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    for (const CellBoundary& side : diagram_.boundary(i))
      ++starts_[static_cast<std::size_t>(side.neighbor) + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  inflows_.resize(starts_.back());
  std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < count; ++i)
    for (const CellBoundary& side : diagram_.boundary(i))
      inflows_[next[static_cast<std::size_t>(side.neighbor)]++] = {static_cast<std::int32_t>(i),
                                                                   side.flux};
}

std::size_t GaussNewtonPart::site(std::size_t member) const {
  return members_.empty() ? member : static_cast<std::size_t>(members_[member]);
}

Vectors GaussNewtonPart::product(const Vectors& v, double delta) const {
  const std::size_t count = v.size();
  std::vector<double> change(count);  // J v: how the capacities change
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      change[i] = own_[i].dot(v[i]);
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k)
        change[i] -= inflows_[k].flux.dot(v[static_cast<std::size_t>(inflows_[k].from)]);
    }
  });
  Vectors result(count);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 sum = change[i] * own_[i];
      for (const CellBoundary& side : diagram_.boundary(i))
        sum -= change[static_cast<std::size_t>(side.neighbor)] * side.flux;
      result[i] = 2.0 * delta * std::max(diagram_.cells[i].mass, least_mass_) * v[i] +
                  2.0 * capacity_weight_ * sum;
    }
  });
  add_pairs(part_.repulsion, v, result);
  return result;
}

void GaussNewtonPart::add_product(const Vectors& v, double delta, Vectors& result) const {
  if (members_.empty()) return add_scaled(result, scale_, product(v, delta));
  Vectors mine(members_.size());
  for (std::size_t k = 0; k < mine.size(); ++k) mine[k] = v[site(k)];
  const Vectors found = product(mine, delta);
  for (std::size_t k = 0; k < found.size(); ++k) result[site(k)] += scale_ * found[k];
}

void GaussNewtonPart::add_blocks(double delta, std::vector<Eigen::Matrix3d>& blocks) const {
  std::vector<Eigen::Matrix3d> mine(own_.size());
  for (std::size_t i = 0; i < own_.size(); ++i) {
    Eigen::Matrix3d block = own_[i] * own_[i].transpose();
    for (const CellBoundary& side : diagram_.boundary(i))
      block += side.flux * side.flux.transpose();
    mine[i] = 2.0 * capacity_weight_ * block;
    mine[i].diagonal().array() += 2.0 * delta * std::max(diagram_.cells[i].mass, least_mass_);
  }
  add_pair_blocks(part_.repulsion, mine);
  for (std::size_t i = 0; i < mine.size(); ++i) blocks[site(i)] += scale_ * mine[i];
}

// ---- all terms ----

GaussNewton::GaussNewton(const Objective& objective, const State& state, int steps,
                         const Context* context)
    : objective_(objective), state_(state), steps_(steps), context_(context) {
  for (std::size_t t = 0; t < state.parts.size(); ++t)
    parts_.emplace_back(state.parts[t], objective.terms[t].members, objective.capacity_weight,
                        objective.scale(t, state.parts[t].energy.gradient.size()));
}

Vectors GaussNewton::apply(const Vectors& v, double delta) const {
  Vectors result(v.size(), Vec3::Zero());
  for (const GaussNewtonPart& part : parts_) part.add_product(v, delta, result);
  add_pairs(state_.discs, v, result);
  for (std::size_t k = 0; k < objective_.anchors.size(); ++k)
    result[k] += 2.0 * objective_.stickiness[k] * v[k];
  objective_.restrict(result, state_.normals);
  return result;
}

// The inverses of H's diagonal blocks, restricted to the tangent planes.
std::vector<Eigen::Matrix3d> GaussNewton::preconditioner(double delta) const {
  std::vector<Eigen::Matrix3d> blocks(state_.sites.size(), Eigen::Matrix3d::Zero());
  for (const GaussNewtonPart& part : parts_) part.add_blocks(delta, blocks);
  add_pair_blocks(state_.discs, blocks);
  for (std::size_t k = 0; k < objective_.anchors.size(); ++k)
    blocks[k].diagonal().array() += 2.0 * objective_.stickiness[k];
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(state_.normals[i]);
    const Eigen::Matrix2d inner = basis.transpose() * blocks[i] * basis;
    blocks[i] = basis * inner.inverse() * basis.transpose();
  }
  return blocks;
}

Vectors GaussNewton::solve(const Vectors& b, double delta) const {
  const std::vector<Eigen::Matrix3d> inverse = preconditioner(delta);
  const auto precondition = [&](const Vectors& v) {
    Vectors result(v.size());
    for (std::size_t k = 0; k < v.size(); ++k) result[k] = inverse[k] * v[k];
    return result;
  };
  Vectors x(b.size(), Vec3::Zero());
  Vectors residual = b;
  Vectors z = precondition(residual);
  Vectors direction = z;
  double rho = dot(residual, z);
  const double enough = kSolverTolerance * kSolverTolerance * rho;
  for (int k = 0; k < steps_ && rho > enough; ++k) {
    if (context_) context_->check();
    const Vectors applied = apply(direction, delta);
    const double curvature = dot(direction, applied);
    if (!(curvature > 0.0)) break;
    add_scaled(x, rho / curvature, direction);
    add_scaled(residual, -rho / curvature, applied);
    z = precondition(residual);
    const double next = dot(residual, z);
    for (std::size_t i = 0; i < direction.size(); ++i)
      direction[i] = z[i] + next / rho * direction[i];
    rho = next;
  }
  return x;
}

}  // namespace dapple
