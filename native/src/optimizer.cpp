// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/optimizer.hpp>
#include <numbers>
#include <optional>

#include "gap.hpp"
#include "gauss_newton.hpp"
#include "lbfgs.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

constexpr double kArmijo = 1e-4;  // share of the predicted decrease that a step must reach
constexpr double kFirstStep =
    0.25;  // of the longest step allowed, when nothing is known of the curvature
constexpr int kBacktracks = 6;  // halvings of a step before it counts as failed
constexpr int kPulls = 8;       // towards the start, of a site that was projected out of reach
constexpr double kPull = 0.8;   // share of its way that is left after each; the last leaves none

// The trust region's delta: how it answers to the outcome of a step.
constexpr double kDeltaTooLong = 2.5;  // the step is longer than allowed ...
constexpr double kDeltaFarOff = 6.0;   // ... by more than
constexpr double kFarOff = 4.0;        // this factor
constexpr double kDeltaFull = 0.4;
constexpr double kDeltaShortened = 2.0;
constexpr double kDeltaFailed = 4.0;
constexpr double kDeltaMost = 1e12;
constexpr int kSolves = 6;    // before the stored pairs are blamed for a step that stays too long
constexpr int kFailures = 5;  // steps in a row without any decrease: rounding is all that is left

/// Where the sites are and what is known there.
struct State {
  Sites sites;
  Vectors normals;
  Energy energy;
  Gap gap;
  Vectors gradient;  // of the total, tangential

  [[nodiscard]] double total() const { return energy.total + gap.energy; }
};

class Minimizer {
 public:
  Minimizer(const Domain& domain, const OptimizerOptions& options, Context* context)
      : domain_(domain), options_(options), context_(context), memory_(options.memory) {}

  OptimizerResult run(const Sites& start) {
    state_ =
        evaluate(start.barycentric.empty() ? domain_.project(start.positions, start.faces) : start);
    start_ = state_.sites;
    freeze_radii();
    note_energy();
    while (!settled() && result_.evaluations < options_.max_evaluations) {
      iterate();
      report_progress();
    }
    result_.converged = settled();
    result_.sites = std::move(state_.sites);
    result_.energy = std::move(state_.energy);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool settled() const {
    return state_.energy.normalised <= options_.target_energy ||
           small_decreases_ >= options_.patience || failures_ >= kFailures;
  }

  State evaluate(Sites sites) {
    State state;
    state.sites = std::move(sites);
    state.energy = evaluate_energy(domain_, state.sites, options_.capacity_weight, context_);
    for (const std::int32_t face : state.sites.faces) state.normals.push_back(domain_.normal(face));
    add_gap(state);
    ++result_.evaluations;
    return state;
  }

  void add_gap(State& state) const {
    const double share =
        domain_.mass() / static_cast<double>(std::max<std::size_t>(state.sites.size(), 1));
    const double weight = radii_.empty() ? 0.0 : options_.gap_weight * share * share;
    state.gap = evaluate_gap(state.energy.diagram, radii_, weight);
    state.gradient = state.energy.gradient;
    add_scaled(state.gradient, 1.0, state.gap.gradient);
    make_tangential(state.gradient, state.normals);
  }

  /// The gap's radii follow the local spacing. They stay fixed within an iteration, so that the
  /// gap's gradient is exact, and between iterations they only shrink, so that it never rises.
  void freeze_radii() {
    if (options_.gap_weight == 0.0 || (domain_.uniform() && !radii_.empty())) return;
    radii_.resize(state_.sites.size(), std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < radii_.size(); ++k)
      radii_[k] = std::min(radii_[k], options_.gap_radius * local_spacing(k));
    add_gap(state_);
  }

  /// Hexagonal spacing at the mean capacity and the cell's own mean density.
  [[nodiscard]] double local_spacing(std::size_t k) const {
    const Moments& cell = state_.energy.diagram.cells[k];
    const double mean = domain_.mass() / static_cast<double>(state_.sites.size());
    const double area = cell.capacity > 0.0 ? mean * cell.area / cell.capacity : 0.0;
    return std::sqrt(2.0 * area / std::numbers::sqrt3);
  }

  void iterate() {
    const Vectors direction =
        options_.method == Method::kTrustRegion ? trust_region_step() : line_search_step();
    const double slope = std::min(dot(direction, state_.gradient), 0.0);
    double t = 1.0;
    std::optional<State> next = backtrack(direction, slope, t);
    if (options_.method == Method::kTrustRegion) answer(next.has_value(), t);
    // A quasi-Newton step promises half its slope: where even that is small, failing to get it is
    // convergence.
    judge(next ? state_.total() - next->total() : -0.5 * slope, next.has_value());
    if (next)
      accept(std::move(*next));
    else
      memory_.forget();
  }

  void judge(double decrease, bool found) {
    decrease_ = decrease / state_.total();
    small_decreases_ = decrease_ > options_.tolerance ? 0 : small_decreases_ + 1;
    failures_ = found ? 0 : failures_ + 1;
  }

  void accept(State next) {
    memory_.remember(difference(next.sites.positions, state_.sites.positions),
                     difference(next.gradient, state_.gradient));
    state_ = std::move(next);
    freeze_radii();
    ++result_.iterations;
    note_energy();
  }

  // A larger delta shortens the model's own step, but not what stored pairs of little curvature add
  // to it.
  Vectors trust_region_step() {
    const GaussNewton model(state_.energy.diagram, state_.gap, state_.normals,
                            options_.capacity_weight);
    const double first_delta = delta_;
    for (int solves = 1;; ++solves) {
      const auto solve = [&](const Vectors& v) { return model.solve(v, delta_); };
      Vectors direction = memory_.direction(state_.gradient, state_.normals, solve);
      const double excess = longest(direction);
      const bool descends = dot(direction, state_.gradient) < 0.0;
      if ((excess <= 1.0 && descends) || delta_ > kDeltaMost) return direction;
      delta_ *= excess > kFarOff ? kDeltaFarOff : kDeltaTooLong;
      if ((descends && solves < kSolves) || memory_.empty()) continue;
      memory_.forget();
      delta_ = first_delta;
    }
  }

  void answer(bool found, double t) {
    if (!found)
      delta_ *= kDeltaFailed;
    else if (t < 1.0)
      delta_ *= kDeltaShortened;
    else
      delta_ = std::max(1.0, kDeltaFull * delta_);
    delta_ = std::min(delta_, kDeltaMost);
  }

  Vectors line_search_step() {
    Vectors direction = plain_direction();
    if (dot(direction, state_.gradient) >= 0.0) {
      memory_.forget();
      direction = plain_direction();
    }
    for (std::size_t k = 0; k < direction.size(); ++k) {
      const double excess = direction[k].norm() / longest_step(k);
      if (excess > 1.0) direction[k] /= excess;
    }
    return direction;
  }

  [[nodiscard]] Vectors plain_direction() const {
    const double scale = memory_.empty() ? first_scale() : memory_.scale();
    return memory_.direction(state_.gradient, state_.normals, [&](Vectors v) {
      for (Vec3& x : v) x *= scale;
      return v;
    });
  }

  [[nodiscard]] double first_scale() const {
    const double excess = longest(state_.gradient);
    return excess > 0.0 ? kFirstStep / excess : 0.0;
  }

  [[nodiscard]] double longest_step(std::size_t k) const {
    return std::max(options_.max_step * local_spacing(k), std::numeric_limits<double>::min());
  }

  /// The longest vector in units of the longest step allowed there.
  [[nodiscard]] double longest(const Vectors& v) const {
    double excess = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k)
      if (state_.energy.diagram.cells[k].capacity > 0.0)
        excess = std::max(excess, v[k].norm() / longest_step(k));
    return excess;
  }

  /// The state after the longest of the steps t = 1, 1/2, 1/4 ... that decreases the energy enough.
  std::optional<State> backtrack(const Vectors& direction, double slope, double& t) {
    for (int k = 0; k < kBacktracks && result_.evaluations < options_.max_evaluations;
         ++k, t *= 0.5) {
      Vectors moved = state_.sites.positions;
      add_scaled(moved, t, direction);
      State next = evaluate(project_within_reach(std::move(moved)));
      if (next.total() <= state_.total() + kArmijo * t * slope) return next;
    }
    return std::nullopt;
  }

  /// How far a site may be from where it started.
  [[nodiscard]] double reach(std::size_t k) const {
    return options_.max_slide * std::min(local_spacing(k), domain_.spacing(state_.sites.size()));
  }

  /// Project, no site farther than its reach. The projection can carry one that was held back
  /// farther again (around a bend, to another sheet): it is pulled towards its start until it does
  /// not.
  [[nodiscard]] Sites project_within_reach(Vectors moved) const {
    if (std::isinf(options_.max_slide)) return domain_.project(moved, state_.sites.faces);
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const Vec3 slide = moved[k] - start_.positions[k];
      const double excess = slide.norm() / reach(k);
      if (excess > 1.0) moved[k] = start_.positions[k] + slide / excess;
    }
    Sites sites = domain_.project(moved, state_.sites.faces);
    for (int pull = 0; pull < kPulls; ++pull)
      pull_back(sites, moved, pull + 1 < kPulls ? kPull : 0.0);
    return sites;
  }

  /// Project the sites out of reach again from the share `part` of their way; 0 is where they
  /// started.
  void pull_back(Sites& sites, Vectors& moved, double part) const {
    std::vector<std::size_t> far;
    Sites pulled;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      if ((sites.positions[k] - start_.positions[k]).norm() <= reach(k)) continue;
      moved[k] = start_.positions[k] + part * (moved[k] - start_.positions[k]);
      far.push_back(k);
      pulled.positions.push_back(moved[k]);
      pulled.faces.push_back(start_.faces[k]);
      pulled.barycentric.push_back(start_.barycentric[k]);
    }
    if (part > 0.0) pulled = domain_.project(pulled.positions, pulled.faces);
    for (std::size_t k = 0; k < far.size(); ++k) {
      sites.positions[far[k]] = pulled.positions[k];
      sites.faces[far[k]] = pulled.faces[k];
      sites.barycentric[far[k]] = pulled.barycentric[k];
    }
  }

  void note_energy() {
    const double scale =
        static_cast<double>(state_.sites.size()) / (domain_.mass() * domain_.mass());
    result_.energies.push_back(scale * state_.total() - options_.capacity_weight);
  }

  // The decrease falls by orders of magnitude until it meets the tolerance.
  void report_progress() const {
    if (!context_) return;
    const double used = double(result_.evaluations) / options_.max_evaluations;
    const double fallen = options_.tolerance > 0.0 && decrease_ > 0.0
                              ? std::log(decrease_) / std::log(std::min(options_.tolerance, 0.5))
                              : 0.0;
    context_->advance(std::clamp(std::max(used, 0.9 * fallen), 0.0, 1.0));
  }

  const Domain& domain_;
  const OptimizerOptions& options_;
  Context* context_;
  State state_;
  Sites start_;
  LbfgsMemory memory_;
  std::vector<double> radii_;  // of the gap, per site; empty without it
  double delta_ = 1.0;
  double decrease_ = 0.0;    // of the last step, relative
  int small_decreases_ = 0;  // in a row
  int failures_ = 0;         // in a row
  OptimizerResult result_;
};

void check(const OptimizerOptions& options) {
  check_at_least("capacity_weight", options.capacity_weight, 0.0);
  check_at_least("gap_weight", options.gap_weight, 0.0);
  check_at_least("gap_radius", options.gap_radius, 0.0);
  check_at_least("tolerance", options.tolerance, 0.0);
  check_at_least("patience", options.patience, 1);
  check_at_least("max_evaluations", options.max_evaluations, 1);
  check_at_least("memory", options.memory, 0);
  check_at_least("max_step", options.max_step, 0.0);
  if (!(options.max_slide >= 0.0))
    throw ArgumentError("max_slide is " + number(options.max_slide) + ": it must be >= 0");
}

}  // namespace

OptimizerResult optimize(const Domain& domain, const Sites& start, const OptimizerOptions& options,
                         Context* context) {
  check(options);
  return Minimizer(domain, options, context).run(start);
}

}  // namespace dapple
