// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/minimizer.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/analysis.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/hexagonal.hpp"
#include "base/validate.hpp"
#include "optimize/gauss_newton.hpp"
#include "optimize/lbfgs.hpp"
#include "optimize/rescue.hpp"

namespace dapple {
namespace {

constexpr double kArmijo = 1e-4;  // share of the predicted decrease that a step must reach
constexpr double kFirstStep =
    0.25;  // of the longest step allowed, when nothing is known of the curvature
constexpr int kBacktracks = 6;      // shortenings of a step before it counts as failed
constexpr int kFewBacktracks = 3;   // while restoring: the next frame goes on
constexpr double kHold = 0.25;      // share of its step that a site beside a jump keeps
constexpr double kHoldMost = 0.05;  // share of the sites that a jump may be blamed on
// What a step rises above its slope falls to a quarter when the step is halved, at a crease to
// half; where more than this is left, the energy jumps, as it does where orphans change owners.
constexpr double kJump = 0.6;
constexpr int kPulls = 8;      // toward the start, of a site that was projected out of reach
constexpr double kPull = 0.8;  // share of its way that is left after each; the last leaves none

// The trust region's delta: how it answers to the outcome of a step.
constexpr double kDeltaTooLong = 2.5;  // the step is longer than allowed ...
constexpr double kDeltaFarOff = 6.0;   // ... by more than
constexpr double kFarOff = 4.0;        // this factor
constexpr double kDeltaFull = 0.4;
constexpr double kDeltaShortened = 2.0;
constexpr double kDeltaFailed = 4.0;
constexpr double kDeltaMost = 1e12;
constexpr int kSolves = 6;  // before the stored pairs are blamed for a step that stays too long
constexpr int kSteps = 15;  // of conjugate gradients: steps are shortened and corrected anyway ...
constexpr int kExactSteps = 60;  // ... but the long waves that a deformation makes take more
// Restoration: what is this close to the aim is left alone.
constexpr double kBegin = 0.7;     // of the variation that is even enough
constexpr double kAsFirst = 1.1;   // of the first frame's
constexpr double kIdle = 1e-3;     // weight of E_cvt
constexpr int kGapPasses = 3;      // over the pairs that a step brings too near
constexpr double kGapMost = 0.25;  // share of the sites that may be held back for it
constexpr int kRescues = 8;        // of sites without a cell, in one run
constexpr double kLocal = 1e-2;    // of the tolerance: what is left to restore is in a few places
constexpr int kFewFailures = 2;    // while restoring
constexpr double kStuck = 5e-4;  // of the energy: what the model may promise where steps are small
constexpr double kRounding = 1e-9;  // of the energy: a promise that rounding may break
constexpr int kFailures = 5;  // steps in a row without any decrease: rounding is all that is left

// Decreases fall with a power of the number of evaluations: c / k^p of the energy at the k-th.
struct Falling {
  double power;
  double first;  // c, from a Poisson-disk start
};
constexpr Falling kTrustRegion{2.0, 4e-3}, kLineSearch{3.0, 1.0};
constexpr double kToRestore = 4.0;   // evaluations that a frame takes
constexpr double kAlmost = 0.8;      // of those expected; the rest comes ever slower
constexpr int kRememberedLeast = 3;  // decreases by which the number is expected, and ...
constexpr int kRememberedPart = 2;   // ... this part of all

/// Tells from how the decreases fall how many evaluations there will be. Nothing but the progress
/// hangs on it.
class Forecast {
 public:
  Forecast(const OptimizerOptions& options, bool restoring)
      : law_(options.method == Method::kTrustRegion ? kTrustRegion : kLineSearch),
        tolerance_(options.tolerance),
        most_(std::max(options.max_evaluations, 1)) {
    if (restoring) {
      most_ = std::min(most_, kToRestore);
      tolerance_ = 0.0;
    }
  }

  void note(int evaluations, double decrease) {
    logs_.push_back(std::log(std::max({decrease, tolerance_, kRounding})) +
                    law_.power * std::log(evaluations));
  }

  [[nodiscard]] double evaluations() const {
    if (!(tolerance_ > 0.0)) return most_;
    const std::size_t last = std::min(
        logs_.size(), std::max<std::size_t>(kRememberedLeast, logs_.size() / kRememberedPart));
    double sum = logs_.empty() ? std::log(law_.first) : 0.0;
    for (std::size_t k = logs_.size() - last; k < logs_.size(); ++k) sum += logs_[k];
    const double c = std::exp(sum / static_cast<double>(std::max<std::size_t>(last, 1)));
    return std::min(most_, std::max(1.0, std::pow(c / tolerance_, 1.0 / law_.power)));
  }

  [[nodiscard]] double progress(int evaluations) const {
    const double share = static_cast<double>(evaluations) / this->evaluations();
    if (share <= kAlmost) return share;
    return 1.0 - (1.0 - kAlmost) * std::exp((kAlmost - share) / (1.0 - kAlmost));
  }

 private:
  Falling law_;
  double tolerance_;
  double most_;
  std::vector<double> logs_;  // of c, at each iteration
};

class Minimizer {
 public:
  Minimizer(const Objective& objective, const OptimizerOptions& options, Context* context)
      : objective_(objective),
        options_(options),
        context_(context),
        history_(options.history),
        radii_(objective.terms.size()),
        forecast_(options, options.restore && options.method == Method::kTrustRegion) {
    if (options.restore && options.method == Method::kTrustRegion) aim_ = &*options.restore;
  }

  Minimum run(const Sites& start, const Sites* home) {
    state_ = evaluate(begin(start, home));
    if (!home) home_ = state_.sites;
    if (out_of_reach())
      state_ = evaluate(project_within_reach(state_.sites.positions, state_.sites.faces));
    freeze_radii();
    if (options_.stickiness > 0.0) stick(objective_, state_, home_.positions, options_.stickiness);
    begin_restoration();
    note_energy();
    rescue();
    while (!settled() && result_.evaluations < options_.max_evaluations) {
      iterate();
      rescue();
      forecast_.note(result_.evaluations, decrease_);
    }
    result_.settled = settled();
    result_.converged = at_minimum();
    result_.state = std::move(state_);
    if (context_) context_->advance(1.0);
    return std::move(result_);
  }

 private:
  [[nodiscard]] Sites begin(const Sites& start, const Sites* home) {
    if (start.barycentric.empty()) return objective_.project(start.positions, start.faces);
    if (home) home_ = *home;
    return start;
  }

  [[nodiscard]] auto onto_surface() const {
    return [this](Vectors& v) { objective_.restrict(v, state_.normals); };
  }

  [[nodiscard]] bool restoring() const { return aim_ != nullptr; }

  void begin_restoration() {
    if (!aim_) return;
    const double above = normalized_cvt(objective_, state_) - (aim_->cvt + aim_->dead_band);
    weigh_cvt(objective_, state_, aim_->share * std::clamp(above / aim_->band, 0.0, 1.0));
    delta_ = least_delta_ = aim_->share;
  }

  /// Even enough to stop; a frame as even as the first is not even begun.
  [[nodiscard]] bool restored() const {
    const double variation = capacity_variation(objective_, state_);
    if (options_.repulsion_weight > 0.0 &&
        measure_evenness(state_.diagram()).alpha_min < aim_->alpha)
      return false;
    if (result_.iterations > 0)
      return variation <= std::max(aim_->variation, aim_->first_variation);
    return variation <= std::max(kBegin * aim_->variation, kAsFirst * aim_->first_variation) &&
           objective_.cvt_weight < kIdle;
  }

  [[nodiscard]] bool settled() const {
    if (restoring() && restored()) return true;
    return normalized_energy(objective_, state_) <= options_.target_energy ||
           small_decreases_ >= options_.patience ||
           failures_ >= (restoring() ? kFewFailures : kFailures);
  }

  /// Whether it ended where it should: settled() also ends where no step is found.
  [[nodiscard]] bool at_minimum() const {
    if (restoring() && restored()) return true;
    if (normalized_energy(objective_, state_) <= options_.target_energy) return true;
    if (small_decreases_ >= options_.patience) return missed_ <= options_.tolerance && !stuck();
    return failures_ > 0 && missed_ <= kRounding;
  }

  /// Whether a full step of the model promises far more than the steps gave: then they are small
  /// because something holds them back, not because nothing is left to gain.
  [[nodiscard]] bool stuck() const {
    if (options_.method != Method::kTrustRegion) return false;
    const GaussNewton model(objective_, state_, kSteps);
    const double promised = 0.5 * dot(model.solve(state_.gradient, least_delta_), state_.gradient);
    return promised > std::max(kStuck, options_.tolerance) * state_.total;
  }

  State evaluate(Sites sites) {
    State state = dapple::evaluate(objective_, std::move(sites), radii_, context_);
    ++result_.evaluations;
    if (context_) context_->advance(forecast_.progress(result_.evaluations));
    return state;
  }

  /// The radii of the repulsion follow the local spacing. They stay fixed within an iteration, so
  /// that the gradient is exact, and between iterations they only shrink, so that the repulsion
  /// never rises.
  void freeze_radii() {
    bool changed = false;
    for (std::size_t t = 0; t < radii_.size(); ++t) {
      const Term& term = objective_.terms[t];
      if (term.repulsion_weight == 0.0 || (term.domain->uniform() && !radii_[t].empty())) continue;
      radii_[t].resize(state_.parts[t].energy.gradient.size(),
                       std::numeric_limits<double>::infinity());
      for (std::size_t k = 0; k < radii_[t].size(); ++k)
        radii_[t][k] = std::min(radii_[t][k], term.repulsion_radius * local_spacing(t, k));
      changed = true;
    }
    if (changed) set_radii(objective_, state_, radii_);
  }

  /// Hexagonal spacing at a term's mean capacity and the cell's own density, averaged by itself:
  /// where there is none, there is no room either.
  [[nodiscard]] double local_spacing(std::size_t term, std::size_t k) const {
    const std::vector<Moments>& cells = state_.parts[term].energy.diagram.cells;
    const double mean = objective_.terms[term].domain->mass() / static_cast<double>(cells.size());
    const double area = cells[k].mass > 0.0 ? mean * cells[k].capacity / cells[k].mass : 0.0;
    return hexagonal_spacing(area);
  }

  void iterate() {
    Vectors direction =
        options_.method == Method::kTrustRegion ? trust_region_step() : line_search_step();
    const double slope = std::min(dot(direction, state_.gradient), 0.0);
    double t = 1.0;
    std::optional<State> next = backtrack(direction, t);
    if (options_.method == Method::kTrustRegion) answer(next.has_value(), t);
    // A quasi-Newton step promises half its slope: where even that is small, or hidden by a jump,
    // failing to get it is convergence.
    const double promised = -0.5 * slope;
    const double hoped = promised > jump_ ? promised : 0.0;
    missed_ = next ? 0.0 : std::max(missed_, promised / state_.total);
    judge(next ? state_.total - next->total : hoped, next.has_value());
    if (next)
      accept(std::move(*next));
    else
      history_.forget();
  }

  void judge(double decrease, bool found) {
    decrease_ = decrease / state_.total;
    const double small = restoring() ? kLocal * options_.tolerance : options_.tolerance;
    small_decreases_ = decrease_ > small ? 0 : small_decreases_ + 1;
    failures_ = found ? 0 : failures_ + 1;
  }

  void accept(State next) {
    history_.remember(difference(next.sites.positions, state_.sites.positions),
                      difference(next.gradient, state_.gradient));
    settle_at(std::move(next));
  }

  void settle_at(State next) {
    state_ = std::move(next);
    freeze_radii();
    ++result_.iterations;
    note_energy();
  }

  /// Move sites without a cell to where there is room, if that lowers what is minimized.
  void rescue() {
    if (result_.evaluations >= options_.max_evaluations || rescues_ >= kRescues) return;
    const Rescue found = find_rescue(objective_, state_);
    if (found.sites.empty()) return;
    ++rescues_;
    Sites moved = state_.sites;
    for (std::size_t k = 0; k < found.sites.size(); ++k) {
      const auto site = static_cast<std::size_t>(found.sites[k]);
      moved.positions[site] = found.positions[k];
      moved.faces[site] = found.faces[k];
    }
    State next = evaluate(project_within_reach(std::move(moved.positions), moved.faces));
    if (!(next.total < state_.total)) return;
    history_.forget();
    small_decreases_ = failures_ = 0;
    missed_ = 0.0;
    settle_at(std::move(next));
  }

  // A larger delta shortens the model's own step, but not what stored pairs of little curvature add
  // to it.
  Vectors trust_region_step() {
    const GaussNewton model(objective_, state_, restoring() ? kExactSteps : kSteps);
    const double first_delta = delta_;
    for (int solves = 1;; ++solves) {
      const auto solve = [&](const Vectors& v) { return model.solve(v, delta_); };
      Vectors direction = history_.direction(state_.gradient, onto_surface(), solve);
      const double excess = longest(direction);
      const bool descends = dot(direction, state_.gradient) < 0.0;
      if ((excess <= 1.0 && descends) || delta_ > kDeltaMost)
        return keep_apart(std::move(direction));
      delta_ *= excess > kFarOff ? kDeltaFarOff : kDeltaTooLong;
      if ((descends && solves < kSolves) || history_.empty()) continue;
      history_.forget();
      delta_ = first_delta;
    }
  }

  // Not where many moves would be shortened: in white noise, or where the repulsions of classes and
  // of all together contradict each other, that costs more than it gives.
  [[nodiscard]] Vectors keep_apart(Vectors direction) const {
    if (radii_.size() > 1) return direction;
    Vectors full = direction;
    for (int pass = 0; pass < kGapPasses; ++pass) {
      const std::size_t shortened = shorten_approaches(state_.diagram(), radii_[0], direction);
      if (static_cast<double>(shortened) > kGapMost * static_cast<double>(direction.size()))
        return full;
      if (shortened == 0) break;
    }
    return direction;
  }

  void answer(bool found, double t) {
    if (!found)
      delta_ *= kDeltaFailed;
    else if (t < 1.0)
      delta_ *= kDeltaShortened;
    else
      delta_ = std::max(least_delta_, kDeltaFull * delta_);
    delta_ = std::min(delta_, kDeltaMost);
  }

  Vectors line_search_step() {
    Vectors direction = plain_direction();
    if (dot(direction, state_.gradient) >= 0.0) {
      history_.forget();
      direction = plain_direction();
    }
    for (std::size_t k = 0; k < direction.size(); ++k) {
      const double excess = direction[k].norm() / longest_step(k);
      if (excess > 1.0) direction[k] /= excess;
    }
    return direction;
  }

  [[nodiscard]] Vectors plain_direction() const {
    const double scale = history_.empty() ? first_scale() : history_.scale();
    return history_.direction(state_.gradient, onto_surface(), [&](Vectors v) {
      for (Vec3& x : v) x *= scale;
      return v;
    });
  }

  [[nodiscard]] double first_scale() const {
    const double excess = longest(state_.gradient);
    return excess > 0.0 ? kFirstStep / excess : 0.0;
  }

  [[nodiscard]] double longest_step(std::size_t k) const {
    return std::max(options_.max_step * local_spacing(0, k), std::numeric_limits<double>::min());
  }

  /// The longest vector in units of the longest step allowed there.
  [[nodiscard]] double longest(const Vectors& v) const {
    double excess = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k)
      if (state_.diagram().cells[k].capacity > 0.0)
        excess = std::max(excess, v[k].norm() / longest_step(k));
    return excess;
  }

  /// The state after the longest of the shortened steps that decreases the energy enough. The trust
  /// region gives up at a jump: another direction is worth more than a shorter step.
  /// \param direction is shortened with it
  /// \param t by how much, for all sites alike
  std::optional<State> backtrack(Vectors& direction, double& t) {
    const int most = restoring() ? kFewBacktracks : kBacktracks;
    double rise = std::numeric_limits<double>::infinity();
    jump_ = 0.0;
    for (int k = 0; k < most && result_.evaluations < options_.max_evaluations; ++k) {
      const double slope = std::min(dot(direction, state_.gradient), 0.0);
      Vectors moved = state_.sites.positions;
      add_scaled(moved, 1.0, direction);
      State next = evaluate(project_within_reach(std::move(moved), state_.sites.faces));
      if (next.total <= state_.total + kArmijo * slope) return next;
      const double before = std::exchange(rise, next.total - state_.total - slope);
      if (options_.method == Method::kTrustRegion) {
        if (rise > kJump * before && !restoring()) {
          jump_ = rise;
          break;
        }
        if (hold_back(next, slope, direction)) continue;
      }
      for (Vec3& v : direction) v *= 0.5;
      t *= 0.5;
    }
    return std::nullopt;
  }

  /// Where cells change pieces the energy jumps, and one such place would stop all sites: if few
  /// cells alone are to blame for a step that failed, only the sites beside them are held back.
  [[nodiscard]] bool hold_back(const State& next, double slope, Vectors& direction) const {
    const std::vector<double> before = energy_shares(objective_, state_);
    std::vector<double> rise = energy_shares(objective_, next);
    std::vector<std::size_t> order(rise.size());
    for (std::size_t k = 0; k < rise.size(); ++k) rise[k] -= before[k];
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto most = static_cast<std::size_t>(kHoldMost * static_cast<double>(order.size()));
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(),
                      [&](std::size_t a, std::size_t b) {
                        return rise[a] != rise[b] ? rise[a] > rise[b] : a < b;
                      });
    double left = next.total - state_.total - 0.5 * slope;  // half the slope is a full step's gain
    std::vector<bool> held(order.size(), false);
    for (std::size_t n = 0; left > 0.0; ++n) {
      if (n >= most || rise[order[n]] <= 0.0) return false;
      left -= rise[order[n]];
      held[order[n]] = true;
      for (const CellBoundary& side : state_.diagram().boundary(order[n]))
        held[static_cast<std::size_t>(side.neighbor)] = true;
    }
    for (std::size_t k = 0; k < held.size(); ++k)
      if (held[k]) direction[k] *= kHold;
    return true;
  }

  /// How far a site may be from its home.
  [[nodiscard]] double reach(std::size_t k) const {
    return options_.max_slide *
           std::min(local_spacing(0, k), objective_.domain().spacing(state_.sites.size()));
  }

  [[nodiscard]] bool out_of_reach() const {
    for (std::size_t k = 0; k < home_.size(); ++k)
      if ((state_.sites.positions[k] - home_.positions[k]).norm() > reach(k)) return true;
    return false;
  }

  /// The projection may carry even a site that has not moved: to where there is density, or by
  /// rounding. Locked sites keep their bytes.
  [[nodiscard]] Sites project(const Vectors& moved, std::span<const std::int32_t> hints) const {
    Sites sites = objective_.project(moved, hints);
    for (std::size_t k = 0; k < objective_.locked.size(); ++k) {
      if (!objective_.locked[k]) continue;
      sites.positions[k] = state_.sites.positions[k];
      sites.faces[k] = state_.sites.faces[k];
      sites.barycentric[k] = state_.sites.barycentric[k];
    }
    return sites;
  }

  /// Project, no site farther than its reach. The projection can carry one that was held back
  /// farther again (around a bend, to another sheet): it is pulled toward its home until it does
  /// not.
  [[nodiscard]] Sites project_within_reach(Vectors moved,
                                           std::span<const std::int32_t> hints) const {
    if (std::isinf(options_.max_slide)) return project(moved, hints);
    for (std::size_t k = 0; k < moved.size(); ++k) {
      const Vec3 slide = moved[k] - home_.positions[k];
      const double excess = slide.norm() / reach(k);
      if (excess > 1.0) moved[k] = home_.positions[k] + slide / excess;
    }
    Sites sites = project(moved, hints);
    for (int pull = 0; pull < kPulls; ++pull)
      pull_back(sites, moved, pull + 1 < kPulls ? kPull : 0.0);
    return sites;
  }

  /// Project the sites out of reach again from the share `part` of their way; 0 is their home.
  void pull_back(Sites& sites, Vectors& moved, double part) const {
    std::vector<std::int32_t> far;
    Sites pulled;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      if ((sites.positions[k] - home_.positions[k]).norm() <= reach(k)) continue;
      moved[k] = home_.positions[k] + part * (moved[k] - home_.positions[k]);
      far.push_back(static_cast<std::int32_t>(k));
      pulled.positions.push_back(moved[k]);
      pulled.faces.push_back(home_.faces[k]);
      pulled.barycentric.push_back(home_.barycentric[k]);
    }
    if (part > 0.0) pulled = objective_.project(pulled.positions, pulled.faces, far);
    put(sites, far, pulled);
  }

  void note_energy() {
    result_.energies.push_back(state_.total / objective_.total_weight() - options_.capacity_weight);
  }

  Objective objective_;
  const OptimizerOptions& options_;
  Context* context_;
  const Restoration* aim_ = nullptr;  // null unless restoring
  State state_;
  Sites home_;
  LbfgsHistory history_;
  std::vector<std::vector<double>> radii_;  // of the repulsion, per term and site; empty without it
  double delta_ = 1.0;
  double least_delta_ = 1.0;
  double decrease_ = 0.0;    // of the last step, relative
  int small_decreases_ = 0;  // in a row
  int failures_ = 0;         // in a row
  double missed_ = 0.0;      // the most that failed steps in a row promised, relative
  int rescues_ = 0;
  double jump_ = 0.0;  // of the energy, that the last step met
  Forecast forecast_;
  Minimum result_;
};

void check(const OptimizerOptions& options) {
  check_at_least("capacity_weight", options.capacity_weight, 0.0);
  check_at_least("repulsion_weight", options.repulsion_weight, 0.0);
  check_at_least("repulsion_radius", options.repulsion_radius, 0.0);
  check_at_least("tolerance", options.tolerance, 0.0);
  check_at_least("patience", options.patience, 1);
  check_at_least("max_evaluations", options.max_evaluations, 1);
  check_at_least("history", options.history, 0);
  check_at_least("max_step", options.max_step, 0.0);
  check_at_least("stickiness", options.stickiness, 0.0);
  if (!(options.max_slide >= 0.0))
    throw ArgumentError("max_slide is " + number(options.max_slide) + ": it must be >= 0");
}

}  // namespace

double expected_evaluations(const OptimizerOptions& options) {
  return Forecast(options, options.restore.has_value()).evaluations();
}

Minimum minimize(const Objective& objective, const Sites& start, const OptimizerOptions& options,
                 Context* context, const Sites* home) {
  check(options);
  return Minimizer(objective, options, context).run(start, home);
}

}  // namespace dapple
