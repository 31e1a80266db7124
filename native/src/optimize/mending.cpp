// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/mending.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/progress.hpp"

namespace dapple {
namespace {

constexpr double kEven = 0.016;    // capacity variation; cells are not mended where it is smaller
constexpr double kOff = 0.06;      // of the mean capacity: cells that are farther off are mended
constexpr double kCrowded = 0.62;  // spacings: where sites on two bodies are nearer, it is mended
constexpr double kNear = 0.64;     // spacings: sites that are nearer in the end are pushed apart
constexpr double kApart = 0.65;    // spacings that they get
constexpr double kOthers = 0.6;    // spacings that others keep from them
constexpr int kRings = 3;          // of neighbors that move along
constexpr int kRounds = 3;
constexpr int kHalvings = 3;       // of the places, where one of them stops the others
constexpr double kHarder = 4.0;    // factor by which the repulsion of two bodies grows
constexpr double kLocal = 1e-2;    // of the tolerance, because a few places make little of the sum
constexpr int kMost = 25;          // evaluations at a time
constexpr double kShare = 4.0;     // of the evaluations so far that may be added
constexpr int kPushes = 8;         // times that sites that are still too near are pushed apart
constexpr double kNearly = 1e-3;   // of the distance: what pushes may leave
constexpr double kProgress = 0.2;  // of what is left of it, for each step
constexpr double kWorse = 1.1;     // factor by which pushes may raise the capacity variation

using Chosen = std::vector<std::size_t>;  // sites, sorted

/// Call visit(i, j, offset from j to i, spacing) for sites on two bodies that are nearer than so
/// many spacings.
template <typename Visit>
void for_each_nearer(const Objective& objective, const Evaluation& state, double than,
                     const Visit& visit) {
  for (const Stranger& pair : state.parts[0].strangers) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const double spacing =
        0.5 * (local_spacing(objective, state, 0, i) + local_spacing(objective, state, 0, j));
    if (pair.offset.norm() < than * spacing) visit(i, j, pair.offset, spacing);
  }
}

/// Also for touching sites of one body that are nearer than others should be.
template <typename Visit>
void for_each_crowded(const Objective& objective, const Evaluation& state, const Visit& visit) {
  for_each_nearer(objective, state, kNear, visit);
  const RestrictedVoronoi& diagram = state.diagram();
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    for (const CellBoundary& side : diagram.boundary(i)) {
      const auto j = static_cast<std::size_t>(side.neighbor);
      if (j <= i) continue;
      const double spacing =
          0.5 * (local_spacing(objective, state, 0, i) + local_spacing(objective, state, 0, j));
      if (side.offset.norm() < kOthers * spacing) visit(i, j, Vec3(-side.offset), spacing);
    }
}

/// How much too near sites are, relative to kNear: the two that are nearest, and all together.
struct Crowding {
  double worst = 0.0, sum = 0.0;
};

Crowding crowding_of(const Objective& objective, const Evaluation& state) {
  Crowding result;
  for_each_crowded(objective, state,
                   [&](std::size_t, std::size_t, const Vec3& offset, double spacing) {
                     const double lacks = 1.0 - offset.norm() / (kNear * spacing);
                     result.worst = std::max(result.worst, lacks);
                     result.sum += lacks;
                   });
  return result;
}

void make_unique(Chosen& sites) {
  std::sort(sites.begin(), sites.end());
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
}

Chosen nearer(const Objective& objective, const Evaluation& state, double than) {
  Chosen result;
  for_each_nearer(objective, state, than, [&](std::size_t i, std::size_t j, const Vec3&, double) {
    result.insert(result.end(), {i, j});
  });
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

/// The sites and rings of neighbors around them.
std::vector<bool> around(const RestrictedVoronoi& diagram, const Chosen& sites) {
  std::vector<bool> result(diagram.cells.size(), false);
  Chosen ring = sites;
  for (const std::size_t k : sites) result[k] = true;
  for (int r = 0; r < kRings; ++r) {
    Chosen next;
    for (const std::size_t k : ring)
      for (const CellBoundary& side : diagram.boundary(k)) {
        const auto j = static_cast<std::size_t>(side.neighbor);
        if (!result[j]) next.push_back(j);
        result[j] = true;
      }
    ring = std::move(next);
  }
  return result;
}

/// The sites in groups whose surroundings do not touch.
std::vector<Chosen> places_of(const RestrictedVoronoi& diagram, const Chosen& sites) {
  const std::vector<bool> free = around(diagram, sites);
  std::vector<bool> seen(free.size(), false);
  std::vector<Chosen> result;
  for (const std::size_t site : sites) {
    if (seen[site]) continue;
    Chosen place = {site};
    seen[site] = true;
    for (std::size_t k = 0; k < place.size(); ++k)
      for (const CellBoundary& side : diagram.boundary(place[k])) {
        const auto j = static_cast<std::size_t>(side.neighbor);
        if (free[j] && !seen[j]) place.push_back(j);
        seen[j] = true;
      }
    std::erase_if(
        place, [&](std::size_t k) { return !std::binary_search(sites.begin(), sites.end(), k); });
    std::sort(place.begin(), place.end());
    result.push_back(std::move(place));
  }
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
        most_(options.max_evaluations),
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
    push_apart();
    if (found_.evaluations > first_) end();
  }

 private:
  /// Minimize around these sites, or in halves if no step is found for all together.
  bool mend(const Chosen& sites, int halvings) {
    if (found_.evaluations + 1 >= last_) return false;
    if (step_around(sites)) return true;
    if (halvings == 0) return false;
    const std::vector<Chosen> places = places_of(found_.state.diagram(), sites);
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
    const std::vector<bool> free = around(found_.state.diagram(), sites);
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

  /// Where the capacities still hold sites of two bodies beside each other, they are pushed apart.
  void push_apart() {
    Evaluation state;
    Sites sites = found_.state.sites;
    const Evaluation* now = &found_.state;
    for (int push = 0; push < kPushes && found_.evaluations + 1 < most_; ++push) {
      if (crowding_of(plain_, *now).sum == 0.0) break;
      sites = pushed(*now);
      update(state, plain_, sites, nullptr);
      check_context(context_);
      now = &state;
      ++found_.evaluations;
    }
    if (now == &found_.state) return;
    const Crowding was = crowding_of(plain_, found_.state), is = crowding_of(plain_, state);
    if (is.worst > was.worst || !(is.sum < was.sum)) return;
    const double before = capacity_variation(plain_, found_.state);
    if (capacity_variation(plain_, state) <= kWorse * std::max(before, kEven))
      found_.state = std::move(state);
  }

  [[nodiscard]] Sites pushed(const Evaluation& state) const {
    std::vector<Contact> contacts;
    const Planes planes{state.normals, plain_.locked};
    const auto keep = [&](std::size_t i, std::size_t j, const Vec3& d, double least) {
      if (d.squaredNorm() > 0.0) add_contact(planes, i, j, d, least, kNearly * least, contacts);
    };
    Chosen sites;
    for_each_crowded(plain_, state,
                     [&](std::size_t i, std::size_t j, const Vec3& offset, double spacing) {
                       keep(i, j, offset, kApart * spacing);
                       sites.insert(sites.end(), {i, j});
                     });
    make_unique(sites);
    for (const std::size_t i : sites)
      for (const CellBoundary& side : state.diagram().boundary(i)) {
        const double spacing = local_spacing(plain_, state, 0, i);
        keep(i, static_cast<std::size_t>(side.neighbor), -side.offset,
             std::min(side.offset.norm(), kOthers * spacing));
      }
    Vectors moves(state.sites.size(), Vec3::Zero());
    separate(contacts, moves);
    std::vector<std::int32_t> moved;
    for (std::size_t k = 0; k < moves.size(); ++k)
      if (moves[k].squaredNorm() > 0.0) moved.push_back(static_cast<std::int32_t>(k));
    Sites some = select(state.sites, moved);
    for (std::size_t k = 0; k < moved.size(); ++k)
      some.positions[k] += moves[static_cast<std::size_t>(moved[k])];
    Sites result = state.sites;
    put(result, moved, plain_.project(some.positions, some.faces, moved, context_));
    return result;
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
  int first_, most_, last_;  // evaluations before it, in all, and before the pushes, at most
  bool settled_ = false;     // whether the last minimization ended by itself
};

}  // namespace

void mend_places(const Objective& objective, const OptimizerOptions& options, Minimum& found,
                 Context* context) {
  if (objective.domain().has_bodies() && objective.terms[0].repulsion_weight > 0.0)
    Mending(objective, options, found, context).run();
}

}  // namespace dapple
