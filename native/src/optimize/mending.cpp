// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/mending.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/progress.hpp"
#include "optimize/neighborhoods.hpp"
#include "optimize/pushing.hpp"

namespace dapple {
namespace {

constexpr double kEven = 0.016;    // capacity variation; cells are not mended where it is smaller
constexpr double kOff = 0.06;      // of the mean capacity: cells that are farther off are mended
constexpr double kCrowded = 0.62;  // spacings: where sites on two bodies are nearer, it is mended
constexpr int kRings = 3;          // of neighbors that move along
constexpr int kRounds = 3;
constexpr int kHalvings = 3;       // of the places, where one of them stops the others
constexpr double kHarder = 4.0;    // factor by which the repulsion of two bodies grows
constexpr double kLocal = 1e-2;    // of the tolerance, because a few places make little of the sum
constexpr int kMost = 25;          // evaluations at a time
constexpr double kShare = 4.0;     // of the evaluations so far that may be added
constexpr double kProgress = 0.2;  // of what is left of it, for each step

/// Sites on two bodies that are nearer than so many spacings.
Chosen nearer(const Objective& objective, const Evaluation& state, double than) {
  Chosen result;
  for (const Stranger& pair : state.parts[0].strangers) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    if (pair.offset.norm() < than * spacing_between(objective, state, i, j))
      result.insert(result.end(), {i, j});
  }
  make_unique(result);
  return result;
}

Chosen far_from_even(const Objective& objective, const Evaluation& state) {
  Chosen result;
  if (!(capacity_variation(objective, state) > kEven)) return result;
  const std::vector<Moments>& cells = state.diagram().cells;
  const double mean = objective.terms[0].mean_capacity(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (std::abs(cells[k].capacity - mean) > kOff * mean) result.push_back(k);
  return result;
}

class Mending {
 public:
  Mending(const Objective& objective, const OptimizerOptions& options, Minimum& found,
          Context* context)
      : plain_(objective),
        objective_(objective),
        options_(options),
        found_(found),
        context_(context),
        first_(found.evaluations),
        last_(std::min(options.max_evaluations,
                       found.evaluations + static_cast<int>(kShare * found.evaluations))) {
    options_.tolerance *= kLocal;
  }

  void run() {
    for (int round = 0; round < kRounds; ++round) {
      Chosen sites = nearer(objective_, found_.state, kCrowded);
      if (!sites.empty()) objective_.strangers_weight *= kHarder;
      const Chosen uneven = far_from_even(objective_, found_.state);
      sites.insert(sites.end(), uneven.begin(), uneven.end());
      make_unique(sites);
      if (sites.empty() || !mend(sites, kHalvings)) break;
    }
    if (found_.evaluations > first_) end();
  }

 private:
  /// Minimize around these sites, or in halves if no step is found for all together.
  bool mend(const Chosen& sites, int halvings) {
    if (found_.evaluations + 1 >= last_) return false;
    if (step_around(sites)) return true;
    if (halvings == 0) return false;
    const std::vector<Chosen> places = places_of(found_.state.diagram(), sites, kRings);
    if (places.size() < 2) return false;
    bool gained = false;
    const auto half = static_cast<std::ptrdiff_t>(places.size() / 2);
    for (const auto& [begin, end] : {std::pair(places.begin(), places.begin() + half),
                                     std::pair(places.begin() + half, places.end())}) {
      Chosen some;
      for (auto place = begin; place != end; ++place)
        some.insert(some.end(), place->begin(), place->end());
      make_unique(some);
      gained = mend(some, halvings - 1) || gained;
    }
    return gained;
  }

  bool step_around(const Chosen& sites) {
    const std::vector<bool> free = around(found_.state.diagram(), sites, kRings);
    Objective local = objective_;
    local.locked.resize(free.size());
    for (std::size_t k = 0; k < free.size(); ++k) local.locked[k] = !free[k];
    options_.max_evaluations = std::min(kMost, last_ - found_.evaluations);
    const double done = context_ ? context_->progress() : 0.0;
    Stretch stepping(context_, done, done + kProgress * (1.0 - done));
    Minimum next = minimize(local, found_.state.sites, options_, stepping.context());
    const bool gained = next.iterations > 0;
    settled_ = next.settled || mean_decrease(next) <= options_.tolerance / kLocal;
    take(std::move(next), gained);
    return gained;
  }

  /// Of a step, relative.
  [[nodiscard]] double mean_decrease(const Minimum& steps) const {
    const double first = steps.energies.front() + objective_.capacity_weight;
    const double decrease = steps.energies.front() - steps.energies.back();
    return decrease / (first * std::max(steps.iterations, 1));
  }

  void take(Minimum next, bool better) {
    found_.evaluations += next.evaluations;
    found_.iterations += next.iterations;
    if (better) found_.state = std::move(next.state);
  }

  /// The state with the plain repulsion. What no step leads on from has converged.
  void end() {
    options_.max_evaluations = 1;
    Minimum next = minimize(plain_, found_.state.sites, options_, nullptr);
    found_.converged = found_.converged || settled_;
    take(std::move(next), true);
  }

  const Objective& plain_;
  Objective objective_;  // with a stronger repulsion between bodies
  OptimizerOptions options_;
  Minimum& found_;
  Context* context_;
  int first_, last_;      // evaluations before it, and at most
  bool settled_ = false;  // whether the last minimization ended by itself
};

}  // namespace

void mend_places(const Objective& objective, const OptimizerOptions& options, Minimum& found,
                 Context* context) {
  if (objective.terms[0].repulsion_weight == 0.0) return;
  if (objective.domain().has_bodies()) Mending(objective, options, found, context).run();
  push_apart(objective, options.max_evaluations, found, context);
}

}  // namespace dapple
