// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/optimizer.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>

#include "validate.hpp"

namespace dapple {
namespace {

using Vectors = std::vector<Vec3>;

constexpr double kArmijo = 1e-4;     // share of the predicted decrease that a step must reach
constexpr int kBacktracks = 8;       // halvings of a step before it counts as failed
constexpr double kFirstStep = 0.25;  // of the longest step allowed, when nothing is known of the curvature

double dot(const Vectors& a, const Vectors& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k].dot(b[k]);
  return sum;
}

void add_scaled(Vectors& a, double factor, const Vectors& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += factor * b[k];
}

Vectors difference(const Vectors& a, const Vectors& b) {
  Vectors result(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) result[k] = a[k] - b[k];
  return result;
}

/// A step taken and the change of the gradient along it.
struct Pair {
  Vectors step;
  Vectors change;
  double curvature;  // step . change
};

/// Where the sites are and what is known there.
struct State {
  Sites sites;
  Energy energy;
  Vectors gradient;  // tangential
};

class Minimizer {
 public:
  Minimizer(const Surface& surface, const Projector& projector, const OptimizerOptions& options, Context* context)
      : surface_(surface), projector_(projector), options_(options), context_(context) {}

  OptimizerResult run(const Sites& start) {
    state_ = evaluate(start.barycentric.empty() ? project(start.positions, start.faces) : start);
    result_.energies.push_back(state_.energy.normalised);
    int small_decreases = 0;
    while (!result_.converged && result_.evaluations < options_.max_evaluations) {
      if (state_.energy.normalised <= options_.target_energy) {
        result_.converged = true;
        break;
      }
      const std::optional<double> decrease = iterate();
      small_decreases = decrease && *decrease > options_.tolerance ? 0 : small_decreases + 1;
      result_.converged = small_decreases >= options_.patience;
      report_progress(decrease.value_or(0.0));
    }
    result_.sites = std::move(state_.sites);
    result_.energy = std::move(state_.energy);
    return std::move(result_);
  }

 private:
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints) const {
    Projection found = projector_.project(points, hints);
    return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
  }

  State evaluate(Sites sites) {
    State state;
    state.sites = std::move(sites);
    state.energy = evaluate_energy(surface_, state.sites, options_.capacity_weight, context_);
    state.gradient = tangential(state.energy.gradient, state.sites);
    ++result_.evaluations;
    return state;
  }

  [[nodiscard]] Vectors tangential(Vectors v, const Sites& sites) const {
    for (std::size_t k = 0; k < v.size(); ++k) {
      const Vec3& normal = surface_.geometry(surface_.ordered_face(sites.faces[k])).normal;
      v[k] -= v[k].dot(normal) * normal;
    }
    return v;
  }

  /// One step; the relative decrease of the energy, or nothing if no step was found.
  std::optional<double> iterate() {
    Vectors direction = tangential(quasi_newton(), state_.sites);
    if (dot(direction, state_.gradient) >= 0.0) {
      pairs_.clear();
      direction = quasi_newton();
    }
    limit(direction);
    std::optional<State> next = line_search(direction);
    if (!next) {
      pairs_.clear();
      return std::nullopt;
    }
    remember(*next);
    const double decrease = (state_.energy.total - next->energy.total) / next->energy.total;
    state_ = std::move(*next);
    ++result_.iterations;
    result_.energies.push_back(state_.energy.normalised);
    return decrease;
  }

  /// Minus the inverse Hessian of the stored pairs times the gradient: the two-loop recursion (Nocedal 1980).
  [[nodiscard]] Vectors quasi_newton() const {
    Vectors q = state_.gradient;
    std::vector<double> alphas;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
      alphas.push_back(dot(pair->step, q) / pair->curvature);
      add_scaled(q, -alphas.back(), pair->change);
    }
    const double scale = pairs_.empty() ? first_scale() : pairs_.back().curvature / dot(pairs_.back().change, pairs_.back().change);
    for (Vec3& v : q) v *= -scale;
    auto alpha = alphas.rbegin();
    for (auto pair = pairs_.begin(); pair != pairs_.end(); ++pair, ++alpha)
      add_scaled(q, -*alpha - dot(pair->change, q) / pair->curvature, pair->step);
    return q;
  }

  [[nodiscard]] double first_scale() const {
    double scale = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < state_.gradient.size(); ++k) {
      const double length = state_.gradient[k].norm();
      if (length > 0.0) scale = std::min(scale, kFirstStep * longest_step(k) / length);
    }
    return std::isfinite(scale) ? scale : 0.0;
  }

  /// Steps are measured in the site's own spacing, so that a dense region does not rule a sparse one.
  [[nodiscard]] double longest_step(std::size_t k) const {
    const Moments& cell = state_.energy.diagram.cells[k];
    const double mean = surface_.mass() / static_cast<double>(state_.sites.size());
    const double area = cell.capacity > 0.0 ? mean * cell.area / cell.capacity : 0.0;
    return options_.max_step * std::sqrt(2.0 * area / std::numbers::sqrt3);
  }

  void limit(Vectors& direction) const {
    for (std::size_t k = 0; k < direction.size(); ++k) {
      const double length = direction[k].norm();
      const double longest = longest_step(k);
      if (length > longest) direction[k] *= longest / length;
    }
  }

  std::optional<State> line_search(const Vectors& direction) {
    double t = 1.0;
    for (int k = 0; k < kBacktracks && result_.evaluations < options_.max_evaluations; ++k, t *= 0.5) {
      Vectors moved = state_.sites.positions;
      add_scaled(moved, t, direction);
      State next = evaluate(project(moved, state_.sites.faces));
      const double predicted = t * dot(direction, state_.gradient);
      if (next.energy.total <= state_.energy.total + kArmijo * std::min(predicted, 0.0)) return next;
    }
    return std::nullopt;
  }

  void remember(const State& next) {
    Pair pair{difference(next.sites.positions, state_.sites.positions), difference(next.gradient, state_.gradient), 0.0};
    pair.curvature = dot(pair.step, pair.change);
    if (pair.curvature <= 1e-12 * std::sqrt(dot(pair.step, pair.step) * dot(pair.change, pair.change))) return;
    pairs_.push_back(std::move(pair));
    if (pairs_.size() > static_cast<std::size_t>(options_.memory)) pairs_.pop_front();
  }

  // The decrease falls by orders of magnitude until it meets the tolerance.
  void report_progress(double decrease) const {
    if (!context_) return;
    const double used = double(result_.evaluations) / options_.max_evaluations;
    const double fallen = options_.tolerance > 0.0 && decrease > 0.0
                              ? std::log(decrease) / std::log(std::min(options_.tolerance, 0.5))
                              : 0.0;
    context_->advance(result_.converged ? 1.0 : std::clamp(std::max(used, 0.9 * fallen), 0.0, 1.0));
  }

  const Surface& surface_;
  const Projector& projector_;
  const OptimizerOptions& options_;
  Context* context_;
  State state_;
  std::deque<Pair> pairs_;
  OptimizerResult result_;
};

void check(const OptimizerOptions& options) {
  check_at_least("capacity_weight", options.capacity_weight, 0.0);
  check_at_least("tolerance", options.tolerance, 0.0);
  check_at_least("patience", options.patience, 1);
  check_at_least("max_evaluations", options.max_evaluations, 1);
  check_at_least("memory", options.memory, 0);
  check_at_least("max_step", options.max_step, 0.0);
}

}  // namespace

OptimizerResult optimize(const Surface& surface, const Projector& projector, const Sites& start,
                         const OptimizerOptions& options, Context* context) {
  check(options);
  return Minimizer(surface, projector, options, context).run(start);
}

}  // namespace dapple
