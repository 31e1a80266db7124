// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/minimizer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "optimize/forecast.hpp"
#include "optimize/line_search.hpp"
#include "optimize/reinsertion.hpp"
#include "optimize/slide_limit.hpp"
#include "optimize/stopping_rule.hpp"
#include "optimize/trust_region.hpp"

namespace dapple {
namespace {

constexpr int kBacktracks = 6;     // times that a step is shortened before it counts as failed
constexpr int kFewBacktracks = 3;  // while restoring: the next frame continues
constexpr int kReinsertions = 8;   // in one run
constexpr int kUncut = 5;          // steps in a row that no jump has cut
constexpr int kGrace = 12;         // additional evaluations, granted once if steps were held back
constexpr double kLocal = 1e-2;    // of the tolerance, if only a few places remain to be restored
constexpr double kLattice = 0.2;   // for a lattice, which each step improves only a little
constexpr double kOneSet = 0.5;    // for one set of sites: after few steps only long waves are left
constexpr int kFailures = 5;       // steps without any decrease: only rounding remains
constexpr int kFewFailures = 2;    // while restoring
constexpr double kStuck =
    5e-4;  // of the energy: the decrease that the model may predict if steps are small
constexpr double kMissed = 2.0;     // times the tolerance: what a last step may promise that fails
constexpr double kHidden = 20.0;    // times the tolerance: what a jump may hide of a last step
constexpr double kRounding = 1e-9;  // of the energy: a predicted decrease below rounding errors

class Minimizer {
 public:
  Minimizer(const Objective& objective, const OptimizerOptions& options, Context* context,
            const Restoration* restoration, const Aim& aim)
      : objective_(objective),
        options_(options),
        context_(context),
        restoration_(options.method == Method::kTrustRegion ? restoration : nullptr),
        aim_(aim),
        history_(keeps_pairs() ? options.history : 0),
        region_(options.max_step, /*exact=*/restoring(), careful()),
        limit_(objective_, options.max_slide),
        rule_(tolerance(), options.patience, restoring() ? kFewFailures : kFailures),
        forecast_(options, tolerance(), restoring()),
        last_(options.max_evaluations) {}

  Minimum run(const Sites& start, const Sites* home) {
    begin(start, home);
    reinsert_empty_cells();
    while (!settled() && !result_.paused &&
           result_.evaluations < std::min(last_, options_.max_evaluations)) {
      iterate();
      reinsert_empty_cells();
      go_on_where_stuck();
      forecast_.note(result_.evaluations, decrease_);
      result_.paused = aim_.pauses && !settled() && aim_.pauses(state_, decrease_);
    }
    result_.settled = settled();
    result_.converged = converged() && !has_empty_cell(objective_, state_);
    result_.state = std::move(state_);
    if (context_ && !result_.paused) context_->advance(1.0);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool restoring() const { return restoration_ != nullptr; }
  [[nodiscard]] bool in_trust_region() const { return options_.method == Method::kTrustRegion; }

  /// Whether the steps begin near a minimum: those of a frame, and those of a lattice, which goes
  /// from one minimum to a better one.
  [[nodiscard]] bool careful() const { return restoring() || objective_.forms_lattice(); }

  /// Whether earlier steps are to tell of second derivatives. Along longer steps the energy is not
  /// quadratic.
  [[nodiscard]] bool keeps_pairs() const { return careful() || !in_trust_region(); }

  [[nodiscard]] double tolerance() const {
    if (restoring()) return kLocal * options_.tolerance;
    if (!in_trust_region() || objective_.terms.size() > 1) return options_.tolerance;
    return (objective_.forms_lattice() ? kLattice : kOneSet) * options_.tolerance;
  }

  void begin(const Sites& start, const Sites* home) {
    const bool projected = start.barycentric.empty();
    evaluate(projected ? objective_.project(start.positions, start.faces, {}, context_) : start,
             state_);
    limit_.set_home(home && !projected ? *home : state_.sites);
    if (limit_.exceeded(state_))
      evaluate(limit_.project(state_, state_.sites.positions, state_.sites.faces, context_),
               state_);
    check_finite_energy(objective_, state_);
    give_room(objective_, state_);
    shrink_radii(objective_, state_);
    const Hold hold{options_.stickiness, options_.slide_smoothing};
    if (hold.stickiness > 0.0 || hold.smoothing > 0.0)
      anchor(objective_, state_, limit_.home().positions, hold);
    if (restoring()) {
      weigh_cvt(objective_, state_, restoration_->cvt_weight(objective_, state_));
      region_.set_least_delta(restoration_->share);
    }
    note_energy();
  }

  void evaluate(Sites sites, Evaluation& state) {
    const int before = result_.evaluations++;
    Stretch evaluating(context_, forecast_.progress(before), forecast_.progress(before + 1));
    update(state, objective_, std::move(sites), evaluating.context());
  }

  /// The state after moves along the surface, null if no evaluation is left.
  const Evaluation* evaluate_at(const Vectors& moves) {
    if (result_.evaluations >= options_.max_evaluations) return nullptr;
    Vectors moved = state_.sites.positions;
    add_scaled(moved, 1.0, moves);
    evaluate(limit_.project(state_, std::move(moved), state_.sites.faces, context_), trial_);
    return &trial_;
  }

  void iterate() {
    const Vectors direction = descent_direction();
    const double slope = std::min(dot(direction, state_.gradient), 0.0);
    const bool sure = !keeps_pairs() && region_.follows_model();
    const Step step = backtrack(objective_, state_, direction,
                                {.most = restoring() ? kFewBacktracks : kBacktracks,
                                 .holds_back = in_trust_region(),
                                 .gives_up = in_trust_region() && !restoring()},
                                [this](const Vectors& moves) { return evaluate_at(moves); });
    region_.update_radius(step.found, step.shortened);
    full_steps_ = step.found && step.shortened == 1.0 ? full_steps_ + 1 : 0;
    update_stopping(step, slope, sure && full_steps_ > 0);
    if (step.found)
      accept();
    else
      history_.forget();
  }

  [[nodiscard]] Vectors descent_direction() {
    return in_trust_region() ? region_.step(objective_, state_, history_, context_)
                             : lbfgs_direction(objective_, state_, options_.max_step, history_);
  }

  /// A quasi-Newton step predicts a decrease of half its slope. If even that is small, or hidden by
  /// a jump, failing to reach it means convergence. Where far more is hidden, a shorter step is
  /// tried.
  void update_stopping(const Step& step, double slope, bool sure) {
    const double promised = -0.5 * slope;
    const bool much = !careful() && promised > kHidden * tolerance() * state_.total;
    const double hoped = much || promised > step.jump ? promised : 0.0;
    decrease_ = (step.found ? state_.total - trial_.total : hoped) / state_.total;
    rule_.update(decrease_, step.found, promised / state_.total, sure);
  }

  void accept() {
    history_.remember(difference(trial_.sites.positions, state_.sites.positions),
                      difference(trial_.gradient, state_.gradient));
    go_on();
  }

  /// Continue from the state that was tried.
  void go_on() {
    std::swap(state_, trial_);
    shrink_radii(objective_, state_);
    ++result_.iterations;
    note_energy();
  }

  /// Move sites without a cell to large cells if that decreases the energy.
  void reinsert_empty_cells() {
    if (result_.evaluations >= options_.max_evaluations || reinsertions_ >= kReinsertions) return;
    const Reinsertion found = find_reinsertion(objective_, state_);
    if (found.sites.empty()) return;
    ++reinsertions_;
    Sites moved = state_.sites;
    for (std::size_t k = 0; k < found.sites.size(); ++k) {
      const auto site = static_cast<std::size_t>(found.sites[k]);
      moved.positions[site] = found.positions[k];
      moved.faces[site] = found.faces[k];
    }
    evaluate(limit_.project(state_, std::move(moved.positions), moved.faces, context_), trial_);
    if (!(trial_.total < state_.total)) return;
    history_.forget();
    rule_.reset();
    go_on();
  }

  /// True once the target energy is reached; frames that are already even are skipped.
  [[nodiscard]] bool reached() const {
    if (normalized_energy(objective_, state_) <= options_.target_energy)
      return std::isinf(aim_.variation) || capacity_variation(objective_, state_) <= aim_.variation;
    if (!restoring()) return false;
    return result_.iterations > 0 ? restoration_->reached(objective_, state_)
                                  : restoration_->unnecessary(objective_, state_);
  }

  [[nodiscard]] bool settled() const { return reached() || rule_.ends(); }

  /// Whether the optimization converged; settled() is also true if no step was found.
  [[nodiscard]] bool converged() {
    if (reached()) return true;
    if (rule_.decreases_are_small())
      return rule_.missed() <= kMissed * options_.tolerance && !stuck();
    return rule_.failed() && rule_.missed() <= kRounding;
  }

  /// Whether a full step of the model predicts far more than the steps gained. Then steps are small
  /// because they are held back, not because of convergence.
  [[nodiscard]] bool stuck() {
    return in_trust_region() && region_.promised(objective_, state_, context_) >
                                    std::max(kStuck, options_.tolerance) * state_.total;
  }

  /// Full steps with small gains do not end the optimization if the model predicts more: they were
  /// short because delta was large, and delta shrinks. Steps cut by a jump do not count as full.
  void go_on_where_stuck() {
    if (restoring() || last_ < options_.max_evaluations || !rule_.decreases_are_small()) return;
    if (full_steps_ < kUncut || reached() || !stuck()) return;
    last_ = result_.evaluations + kGrace;
    rule_.reset();
  }

  /// Energies in the unit of the first state, because the owned area may change slightly.
  void note_energy() {
    if (result_.energies.empty()) owned_ = owned_share(objective_, state_, 0);
    result_.energies.push_back(state_.total / objective_.total_weight() / (owned_ * owned_) -
                               options_.capacity_weight);
  }

  Objective objective_;
  const OptimizerOptions& options_;
  Context* context_;
  const Restoration* restoration_;  // null: minimize on
  Aim aim_;
  Evaluation state_;
  Evaluation trial_;  // where a step leads; its memory is that of earlier ones
  LbfgsHistory history_;
  TrustRegion region_;
  SlideLimit limit_;
  StoppingRule rule_;
  Forecast forecast_;
  double decrease_ = 0.0;  // of the last step, relative
  double owned_ = 1.0;     // owned share of the capacity at the start, see owned_share()
  int reinsertions_ = 0;
  int full_steps_ = 0;  // in a row
  int last_;            // last evaluation: before the limit if a stuck optimization has continued
  Minimum result_;
};

}  // namespace

Minimum minimize(const Objective& objective, const Sites& start, const OptimizerOptions& options,
                 Context* context, const Tracked& tracked, const Aim& aim) {
  check_options(options);
  const StageSpan solving(context, Stage::kSolver);
  return Minimizer(objective, options, context, tracked.restoration, aim).run(start, tracked.home);
}

}  // namespace dapple
