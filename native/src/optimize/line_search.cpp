// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/line_search.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "optimize/step_limit.hpp"

namespace dapple {
namespace {

constexpr double kArmijo = 1e-4;  // share of the predicted decrease that a step must reach
constexpr double kFirstStep =
    0.25;  // of the longest step allowed, when nothing is known of the curvature
constexpr double kHold = 0.25;      // share of its step that a site beside a jump keeps
constexpr double kHoldMost = 0.05;  // largest share of sites to which a jump is attributed
// If a step is halved, the rise of the energy above its slope falls to a quarter, or to half at a
// crease. If a larger share than this remains, the energy jumps, for example because uncovered
// faces change owners.
constexpr double kJump = 0.6;

double first_scale(const Objective& objective, const Evaluation& state, double max_step) {
  const double excess = step_excess(objective, state, max_step, state.gradient);
  return excess > 0.0 ? kFirstStep / excess : 0.0;
}

Vectors uncut_direction(const Objective& objective, const Evaluation& state, double max_step,
                        const LbfgsHistory& history) {
  const double scale = history.empty() ? first_scale(objective, state, max_step) : history.scale();
  const auto restrict = [&](Vectors& v) { objective.restrict(v, state.normals); };
  return history.direction(state.gradient, restrict, [&](Vectors v) {
    for (Vec3& x : v) x *= scale;
    return v;
  });
}

/// The sites at which the energy rises most, in descending order, up to kHoldMost of all.
std::vector<std::size_t> worst_sites(const std::vector<double>& rise) {
  std::vector<std::size_t> order(rise.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto most = static_cast<std::size_t>(kHoldMost * static_cast<double>(order.size()));
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(),
      [&](std::size_t a, std::size_t b) { return rise[a] != rise[b] ? rise[a] > rise[b] : a < b; });
  order.resize(most);
  return order;
}

/// The energy jumps where cells exchange pieces, and one such place would stop all sites. If few
/// cells cause a step to fail, only the sites beside them are held back.
bool hold_back(const Objective& objective, const Evaluation& from, const Evaluation& next,
               double slope, Vectors& direction) {
  const std::vector<double> before = energy_shares(objective, from);
  std::vector<double> rise = energy_shares(objective, next);
  for (std::size_t k = 0; k < rise.size(); ++k) rise[k] -= before[k];
  double left = next.total - from.total - 0.5 * slope;  // a full step gains half the slope
  std::vector<bool> held(rise.size(), false);
  for (const std::size_t site : worst_sites(rise)) {
    if (!(left > 0.0) || rise[site] <= 0.0) break;
    left -= rise[site];
    held[site] = true;
    for (const CellBoundary& side : from.diagram().boundary(site))
      held[static_cast<std::size_t>(side.neighbor)] = true;
  }
  if (left > 0.0) return false;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (held[k]) direction[k] *= kHold;
  return true;
}

}  // namespace

Vectors lbfgs_direction(const Objective& objective, const Evaluation& state, double max_step,
                        LbfgsHistory& history) {
  Vectors direction = uncut_direction(objective, state, max_step, history);
  if (dot(direction, state.gradient) >= 0.0) {
    history.forget();
    direction = uncut_direction(objective, state, max_step, history);
  }
  for (std::size_t k = 0; k < direction.size(); ++k) {
    const double excess = direction[k].norm() / longest_step(objective, state, max_step, k);
    if (excess > 1.0) direction[k] /= excess;
  }
  return direction;
}

Step backtrack(const Objective& objective, const Evaluation& from, Vectors direction,
               const Backtracking& how,
               const std::function<const Evaluation*(const Vectors& moves)>& at) {
  Step step;
  double rise = std::numeric_limits<double>::infinity();
  for (int k = 0; k < how.most; ++k) {
    const double slope = std::min(dot(direction, from.gradient), 0.0);
    const Evaluation* next = at(direction);
    if (!next) break;
    step.found = next->total <= from.total + kArmijo * slope;
    if (step.found) break;
    const double before = std::exchange(rise, next->total - from.total - slope);
    if (how.gives_up && rise > kJump * before) {
      step.jump = rise;
      break;
    }
    if (how.holds_back && hold_back(objective, from, *next, slope, direction)) continue;
    for (Vec3& v : direction) v *= 0.5;
    step.shortened *= 0.5;
  }
  return step;
}

}  // namespace dapple
